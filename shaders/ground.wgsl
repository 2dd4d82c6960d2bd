// The ground patch: a plane with a grid that thins out and fades towards the patch's edge, and shadows on it.
//
// Two fragment entry points, because on a processor both sides of a branch cost the same.

@group(0) @binding(1) var shadow_map: texture_depth_2d;
@group(0) @binding(2) var shadow_sampler: sampler_comparison;

const SHADOW_TEXEL: f32 = 1.0 / 1024.0;

struct Point {
    @builtin(position) clip: vec4<f32>,
    // Over the plane, from the patch's centre, in units of half the patch's edge.
    @location(0) patch_at: vec2<f32>,
    @location(1) world: vec3<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Point {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let xz = view.ground.xy + corner * view.ground.z;
    var p: Point;
    p.world = vec3<f32>(xz.x, view.light.w, xz.y);
    p.clip = view.view_proj * vec4<f32>(p.world, 1.0);
    p.patch_at = corner;
    return p;
}

// How much of a pixel the grid lines cover. Lines narrower than a pixel stay a pixel wide and become fainter; where
// lines are closer than pixels only their mean is left, so that nothing shimmers (after Ben Golus, "The Best Darn Grid
// Shader (Yet)").
fn grid(at: vec2<f32>, line_width: f32) -> f32 {
    let pixel = max(fwidth(at), vec2<f32>(1e-6));
    let width = vec2<f32>(line_width);
    let drawn = clamp(width, pixel, vec2<f32>(0.5));
    let blur = pixel * 1.5;
    let distance = 1.0 - abs(fract(at) * 2.0 - 1.0);
    var lines = smoothstep(drawn + blur, drawn - blur, distance);
    lines *= clamp(width / drawn, vec2<f32>(0.0), vec2<f32>(1.0));
    lines = mix(lines, width, clamp(pixel * 2.0 - 1.0, vec2<f32>(0.0), vec2<f32>(1.0)));
    return mix(lines.x, 1.0, lines.y);
}

// Share of the light that reaches a point: 3×3 texels of the map by four comparisons, each already smoothed over the
// four texels round it.
fn light_reaching(world: vec3<f32>) -> f32 {
    let at = view.light_view_proj * vec4<f32>(world, 1.0);
    let uv = at.xy * 0.5 + 0.5;
    let h = SHADOW_TEXEL * 0.6;
    let sum = lit(uv, vec2<f32>(-h, -h), at.z)
        + lit(uv, vec2<f32>(h, -h), at.z)
        + lit(uv, vec2<f32>(-h, h), at.z)
        + lit(uv, vec2<f32>(h, h), at.z);
    // Nothing outside the map casts a shadow.
    let inside = all(abs(at.xy) < vec2<f32>(1.0)) && at.z < 1.0;
    return select(1.0, sum * 0.25, inside);
}

fn lit(uv: vec2<f32>, offset: vec2<f32>, depth: f32) -> f32 {
    return textureSampleCompareLevel(shadow_map, shadow_sampler, uv + offset, depth);
}

fn shade(p: Point, light: f32) -> vec4<f32> {
    let cell = view.ground.w;
    let minor = grid((p.world.xz + view.grid_phase.xy) / cell, 0.016);
    let major = grid((p.world.xz + view.grid_phase.zw) / (cell * GRID_STEP), 0.006);
    let base = view.ground_colour.xyz;
    let surface = base * mix(0.30, 1.0, light);
    let lines = base * mix(0.45, 1.0, light);
    let colour = surface * 0.62 + lines * (minor * 0.75 + major * 1.5);
    // Seen at a flat angle the ground passes into the horizon.
    let fade = 1.0 - smoothstep(0.35, 1.0, length(p.patch_at));
    return vec4<f32>(colour, fade);
}

@fragment
fn fragment_shadowed(p: Point) -> @location(0) vec4<f32> {
    return shade(p, light_reaching(p.world));
}

@fragment
fn fragment_plain(p: Point) -> @location(0) vec4<f32> {
    return shade(p, 1.0);
}
