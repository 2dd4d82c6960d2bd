// Limbs and marks: instances of a unit mesh stretched between two points.
//
// A capsule's vertices belong to one of its two ends; a sphere is a capsule whose ends coincide; a cube is a mesh of
// its own with both ends at its centre.

struct Vertex {
    // Offset from the end this vertex belongs to, in radii; y runs from the first end to the second.
    @location(0) offset: vec3<f32>,
    @location(1) normal: vec3<f32>,
    // 0: first end, 1: second end.
    @location(2) end: f32,
}

struct Instance {
    // First end; w is the radius.
    @location(3) from_radius: vec4<f32>,
    // Second end.
    @location(4) to: vec4<f32>,
    @location(5) colour: vec4<f32>,
}

struct Surface {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) colour: vec3<f32>,
}

// Axes of an instance: y from end to end, x and z across; the world's axes when the ends coincide.
fn axes(span: vec3<f32>, radius: f32) -> mat3x3<f32> {
    let len = length(span);
    if len < radius * 1e-3 {
        return mat3x3<f32>(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(0.0, 0.0, 1.0));
    }
    let y = span / len;
    // Crossed with the world axis that it is least along.
    let helper = select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 0.0, 1.0), abs(y.x) > abs(y.z));
    let x = normalize(cross(y, helper));
    return mat3x3<f32>(x, y, cross(x, y));
}

fn place(v: Vertex, i: Instance, turn: mat3x3<f32>) -> vec3<f32> {
    return mix(i.from_radius.xyz, i.to.xyz, v.end) + turn * v.offset * i.from_radius.w;
}

fn axes_of(i: Instance) -> mat3x3<f32> {
    return axes(i.to.xyz - i.from_radius.xyz, i.from_radius.w);
}

@vertex
fn vertex(v: Vertex, i: Instance) -> Surface {
    let turn = axes_of(i);
    var s: Surface;
    s.world = place(v, i, turn);
    s.clip = view.view_proj * vec4<f32>(s.world, 1.0);
    s.normal = turn * v.normal;
    s.colour = i.colour.xyz;
    return s;
}

@fragment
fn fragment(s: Surface) -> @location(0) vec4<f32> {
    let n = normalize(s.normal);
    let eye = to_eye(s.world);
    let light = view.light.xyz;
    // A warm key light, a cool sky above, and light thrown back by the ground.
    let wrapped = clamp(dot(n, light) * 0.8 + 0.2, 0.0, 1.0);
    let key = vec3<f32>(1.00, 0.95, 0.88) * wrapped * wrapped * 1.35;
    let sky = mix(vec3<f32>(0.15, 0.14, 0.135), vec3<f32>(0.40, 0.44, 0.52), n.y * 0.5 + 0.5);
    // Near the ground less of the sky is seen.
    let height = (s.world.y - view.light.w) / view.ground_colour.w;
    let open = mix(0.65, 1.0, smoothstep(0.0, 0.25, height));
    // The powers are products: on a processor a power is a logarithm and an exponential.
    let halfway = max(dot(n, normalize(light + eye)), 0.0);
    let h4 = halfway * halfway * halfway * halfway;
    let h16 = h4 * h4 * h4 * h4;
    let gloss = h16 * h16 * 0.14;
    let grazing = 1.0 - max(dot(n, eye), 0.0);
    let edge = grazing * grazing * grazing * 0.10;
    let colour = s.colour * (key + sky * open) + vec3<f32>(gloss) + edge * vec3<f32>(0.6, 0.7, 0.9) * open;
    return vec4<f32>(colour, 1.0);
}

// The same shapes seen from the light, for the shadow map.
var<immediate> from_light: mat4x4<f32>;

@vertex
fn vertex_shadow(v: Vertex, i: Instance) -> @builtin(position) vec4<f32> {
    return from_light * vec4<f32>(place(v, i, axes_of(i)), 1.0);
}
