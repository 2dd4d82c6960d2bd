// What the shaders of the world share: one view of the picture. `build.rs` appends this file to each shader.
//
// Positions are in the world, relative to the scene's origin, in the clip's length unit. Colours are linear.

struct View {
    // World to clip space: y down, depth 0 at the near plane and 1 at the far plane.
    view_proj: mat4x4<f32>,
    // World to the shadow map: xy in -1..1, depth 0..1.
    light_view_proj: mat4x4<f32>,
    // Eye point; w is 1 in perspective and 0 where all lines of sight are parallel.
    eye: vec4<f32>,
    // Unit direction of sight; w is how far ribbons are drawn before what they lie on.
    forward: vec4<f32>,
    // Half the view's width and height at distance 1 (zero when parallel); w is the view's size in pixels.
    right: vec4<f32>,
    up: vec4<f32>,
    // Unit direction to the light; w is the height of the ground.
    light: vec4<f32>,
    // Ground patch: centre x, centre z, half its edge, distance between grid lines.
    ground: vec4<f32>,
    // Ground colour; w is the body height.
    ground_colour: vec4<f32>,
    // Where the origin lies in its grid cell (x, z), and in its larger cell of GRID_STEP cells.
    grid_phase: vec4<f32>,
    // x: width of a line of relative width 1, in pixels.
    line: vec4<f32>,
}

@group(0) @binding(0) var<uniform> view: View;

// Every so many grid lines one is stronger.
const GRID_STEP: f32 = 5.0;

// Colours of the surroundings by direction: straight up, level, straight down.
const ZENITH: vec3<f32> = vec3<f32>(0.0065, 0.0078, 0.0110);
const HORIZON: vec3<f32> = vec3<f32>(0.0400, 0.0480, 0.0640);
const NADIR: vec3<f32> = vec3<f32>(0.0180, 0.0205, 0.0260);

// The surroundings seen in a direction: a dark sky with a soft band of light at the horizon.
fn surroundings(direction: vec3<f32>) -> vec3<f32> {
    let y = direction.y;
    let far_side = select(NADIR, ZENITH, y > 0.0);
    return mix(HORIZON, far_side, smoothstep(0.0, 1.0, sqrt(min(abs(y) * 1.6, 1.0))));
}

// Unit direction from a point to the eye.
fn to_eye(point: vec3<f32>) -> vec3<f32> {
    let parallel = -view.forward.xyz;
    let toward = normalize(view.eye.xyz - point + parallel * 1e-6);
    return normalize(mix(parallel, toward, view.eye.w));
}
