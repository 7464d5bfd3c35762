// The finished picture, put where the viewport is in the window.
@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var nearest: sampler;

struct Corner {
    @builtin(position) at: vec4<f32>,
    @location(0) place: vec2<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> Corner {
    let x = f32((i << 1u) & 2u);
    let y = f32(i & 2u);
    return Corner(vec4(x * 2.0 - 1.0, 1.0 - y * 2.0, 0.0, 1.0), vec2(x, y));
}

@fragment
fn fragment(in: Corner) -> @location(0) vec4<f32> {
    return textureSample(picture, nearest, in.place);
}
