// The background: one triangle over the whole view, coloured by the direction of sight.

struct Corner {
    @builtin(position) clip: vec4<f32>,
    // -1..1 over the view, y up.
    @location(0) screen: vec2<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    // (-1,-1), (3,-1), (-1,3): its middle covers the view.
    let at = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    var corner: Corner;
    corner.clip = vec4<f32>(at, 1.0, 1.0);
    corner.screen = vec2<f32>(at.x, -at.y);
    return corner;
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4<f32> {
    let s = corner.screen;
    let direction = normalize(view.forward.xyz + view.right.xyz * s.x + view.up.xyz * s.y);
    // The corners are a little darker, so that the eye rests in the middle.
    let vignette = 1.0 - 0.12 * dot(s, s);
    return vec4<f32>(surroundings(direction) * vignette, 1.0);
}
