// Curves: each segment is a flat quad facing the viewer, of constant width in pixels, with round ends.
//
//        side = +1   2─────────────────3
//                    │  a ───────── b  │      the quad is half a width and a pixel larger than the segment
//        side = -1   0─────────────────1

struct Segment {
    // First point; w is the length of the curve up to it.
    @location(0) a: vec4<f32>,
    // Second point; w is the length of the curve up to it.
    @location(1) b: vec4<f32>,
    // Colour; w is the opacity.
    @location(2) colour: vec4<f32>,
    // x: width relative to the picture's line width; y: length of a dash with its gap, 0 for an unbroken line.
    @location(3) style: vec2<f32>,
}

struct Strip {
    @builtin(position) clip: vec4<f32>,
    // Pixels along and across the segment, from its first point.
    @location(0) @interpolate(linear) local: vec2<f32>,
    // x: length of the segment, y: half the width, both in pixels.
    @location(1) @interpolate(flat) extent: vec2<f32>,
    @location(2) along: f32,
    @location(3) @interpolate(flat) colour: vec4<f32>,
    @location(4) @interpolate(flat) dash: f32,
}

// Share of a dash's period that is drawn.
const DASH_ON: f32 = 0.58;

@vertex
fn vertex(@builtin(vertex_index) index: u32, s: Segment) -> Strip {
    // Drawn a little before what the curve lies on, along the line of sight, so that it does not sink into it.
    let near_a = s.a.xyz + to_eye(s.a.xyz) * view.forward.w;
    let near_b = s.b.xyz + to_eye(s.b.xyz) * view.forward.w;
    var a = view.view_proj * vec4<f32>(near_a, 1.0);
    var b = view.view_proj * vec4<f32>(near_b, 1.0);
    var strip: Strip;
    if a.z <= 0.0 && b.z <= 0.0 {
        // Behind the viewer: outside of every view.
        strip.clip = vec4<f32>(2.0, 2.0, 0.5, 1.0);
        return strip;
    }
    var along = vec2<f32>(s.a.w, s.b.w);
    // The end behind the near plane is moved onto it.
    if a.z < 0.0 {
        let t = a.z / (a.z - b.z);
        a = mix(a, b, t);
        along.x = mix(along.x, along.y, t);
    } else if b.z < 0.0 {
        let t = b.z / (b.z - a.z);
        b = mix(b, a, t);
        along.y = mix(along.y, along.x, t);
    }
    let half_size = vec2<f32>(view.right.w, view.up.w) * 0.5;
    let pixel_a = a.xy / a.w * half_size;
    let pixel_b = b.xy / b.w * half_size;
    let len = distance(pixel_a, pixel_b);
    let direction = select(vec2<f32>(1.0, 0.0), (pixel_b - pixel_a) / max(len, 1e-6), len > 1e-3);
    let half_width = view.line.x * s.style.x * 0.5;
    let reach = half_width + 1.0;
    let second = f32(index & 1u);
    let side = f32(index >> 1u) * 2.0 - 1.0;
    let pixel = mix(pixel_a, pixel_b, second)
        + direction * reach * (second * 2.0 - 1.0)
        + vec2<f32>(-direction.y, direction.x) * reach * side;
    let end = mix(a, b, second);
    strip.clip = vec4<f32>(pixel / half_size * end.w, end.z, end.w);
    strip.local = vec2<f32>(second * len + reach * (second * 2.0 - 1.0), reach * side);
    strip.extent = vec2<f32>(len, half_width);
    strip.along = mix(along.x, along.y, second);
    strip.colour = s.colour;
    strip.dash = s.style.y;
    return strip;
}

// Share of the pixel that a dash covers; where dashes are smaller than pixels, their mean.
fn dashes(along: f32, period: f32) -> f32 {
    if period <= 0.0 {
        return 1.0;
    }
    let at = along / period;
    let pixel = max(fwidth(at), 1e-5);
    let distance = DASH_ON * 0.5 - abs(fract(at) - 0.5);
    let crisp = clamp(distance / pixel + 0.5, 0.0, 1.0);
    return mix(crisp, DASH_ON, smoothstep(0.25, 0.6, pixel));
}

@fragment
fn fragment(strip: Strip) -> @location(0) vec4<f32> {
    let beyond = max(max(-strip.local.x, strip.local.x - strip.extent.x), 0.0);
    let distance = length(vec2<f32>(beyond, strip.local.y));
    let cover = clamp(strip.extent.y - distance + 0.5, 0.0, 1.0);
    return vec4<f32>(strip.colour.xyz, strip.colour.w * cover * dashes(strip.along, strip.dash));
}
