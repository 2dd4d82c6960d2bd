// Glyphs and plain boxes, in pixels of the whole picture.
//
// A glyph is eight rows of eight pixels, 64 bits, and travels in its instance: there is no font texture.

struct Glyph {
    // Left, top, width, height in pixels.
    @location(0) place: vec4<f32>,
    @location(1) colour: vec4<f32>,
    // Rows 0–3 and rows 4–7, the lowest bit of each byte on the left.
    @location(2) bits: vec2<u32>,
    // 0: the glyph, 1: a rim of one font pixel round it.
    @location(3) rim: u32,
}

struct Cell {
    @builtin(position) clip: vec4<f32>,
    // In font pixels, 0..8 inside the glyph.
    @location(0) @interpolate(linear) at: vec2<f32>,
    @location(1) @interpolate(flat) colour: vec4<f32>,
    @location(2) @interpolate(flat) bits: vec2<u32>,
    @location(3) @interpolate(flat) rim: u32,
}

struct PictureSize {
    pixels: vec2<f32>,
}

var<immediate> picture: PictureSize;

@vertex
fn vertex(@builtin(vertex_index) index: u32, g: Glyph) -> Cell {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u));
    let margin = f32(g.rim);
    let at = mix(vec2<f32>(-margin), vec2<f32>(8.0 + margin), corner);
    let pixel = g.place.xy + at / 8.0 * g.place.zw;
    var cell: Cell;
    cell.clip = vec4<f32>(pixel / picture.pixels * 2.0 - 1.0, 0.0, 1.0);
    cell.at = at;
    cell.colour = g.colour;
    cell.bits = g.bits;
    cell.rim = g.rim;
    return cell;
}

fn inked(bits: vec2<u32>, x: i32, y: i32) -> bool {
    if x < 0 || x > 7 || y < 0 || y > 7 {
        return false;
    }
    let half = select(bits.x, bits.y, y > 3);
    return ((half >> u32((y & 3) * 8 + x)) & 1u) == 1u;
}

@fragment
fn fragment(cell: Cell) -> @location(0) vec4<f32> {
    let x = i32(floor(cell.at.x));
    let y = i32(floor(cell.at.y));
    var ink = inked(cell.bits, x, y);
    if cell.rim == 1u {
        for (var dy = -1; dy <= 1; dy++) {
            for (var dx = -1; dx <= 1; dx++) {
                ink = ink || inked(cell.bits, x + dx, y + dy);
            }
        }
    }
    return vec4<f32>(cell.colour.xyz, select(0.0, cell.colour.w, ink));
}
