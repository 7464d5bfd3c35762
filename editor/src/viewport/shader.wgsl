// Faces, lines of a width in pixels, and round points; colours per part where there are any.
struct Uniforms {
    matrix: mat4x4<f32>,
    face: vec4<f32>,
    line: vec4<f32>,
    eye: vec4<f32>,
    // Width and height of the picture, width of lines and size of points, in pixels.
    pixels: vec4<f32>,
    // Normal and distance of the plane in front of which nothing is drawn; all 0 for none.
    clip: vec4<f32>,
}
@group(0) @binding(0) var<uniform> u: Uniforms;
@group(0) @binding(1) var<storage, read> colours: array<u32>;

struct Face {
    @builtin(position) at: vec4<f32>,
    // Of a triangle's first vertex.
    @location(0) @interpolate(flat) normal: vec3<f32>,
    @location(1) @interpolate(flat) part: u32,
    @location(2) clipped: f32,
}

fn clipped(at: vec3<f32>) -> f32 {
    return dot(u.clip.xyz, at) + u.clip.w;
}

@vertex
fn face_vertex(@location(0) at: vec3<f32>, @location(1) normal: vec4<f32>, @location(2) part: u32) -> Face {
    return Face(u.matrix * vec4(at, 1.0), normal.xyz, part, clipped(at));
}

fn of_part(part: u32, plain: vec3<f32>) -> vec3<f32> {
    let colour = colours[min(part, arrayLength(&colours) - 1u)];
    if colour == 0u {
        return plain;
    }
    return unpack4x8unorm(colour).xyz;
}

@fragment
fn face_fragment(in: Face, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    if in.clipped > 0.0 {
        discard;
    }
    var n = normalize(in.normal);
    if dot(n, u.eye.xyz) < 0.0 && u.eye.w > 0.5 {
        n = -n;
    }
    let sun = normalize(vec3(0.35, -0.45, 0.82));
    let light = 0.42 + 0.46 * max(dot(n, sun), 0.0) + 0.14 * n.z;
    return vec4(of_part(in.part, u.face.rgb) * light, 1.0);
}

struct Stroke {
    @builtin(position) at: vec4<f32>,
    @location(0) place: vec2<f32>,
    @location(1) @interpolate(flat) part: u32,
    @location(2) clipped: f32,
}

@vertex
fn line_vertex(
    @builtin(vertex_index) corner: u32,
    @location(0) start: vec3<f32>,
    @location(1) stop: vec3<f32>,
    @location(2) part: u32,
) -> Stroke {
    return stroke(corner, start, stop, part);
}

// Corners of bodies: place, normal and part, five words each.
@group(1) @binding(2) var<storage, read> corners: array<u32>;

fn corner_at(i: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(vec3(corners[5u * i], corners[5u * i + 1u], corners[5u * i + 2u]));
}

@vertex
fn edge_vertex(@builtin(vertex_index) corner: u32, @location(0) ends: vec2<u32>) -> Stroke {
    return stroke(corner, corner_at(ends.x), corner_at(ends.y), corners[5u * ends.x + 4u]);
}

fn stroke(corner: u32, start: vec3<f32>, stop: vec3<f32>, part: u32) -> Stroke {
    var a = u.matrix * vec4(start, 1.0);
    var b = u.matrix * vec4(stop, 1.0);
    // What lies behind the eye is cut off where the eye's plane is.
    let near = 1e-6;
    if a.w < near && b.w < near {
        return Stroke(vec4(2.0, 2.0, 2.0, 1.0), vec2(0.0), part, 0.0);
    }
    if a.w < near { a = mix(a, b, (near - a.w) / (b.w - a.w)); }
    if b.w < near { b = mix(b, a, (near - b.w) / (a.w - b.w)); }
    let along = (b.xy / b.w - a.xy / a.w) * u.pixels.xy;
    let long = max(length(along), 1e-6);
    let side = vec2(-along.y, along.x) / long * u.pixels.z / u.pixels.xy;
    var end = a;
    var away = clipped(start);
    if corner == 2u || corner == 4u || corner == 5u {
        end = b;
        away = clipped(stop);
    }
    var turn = 1.0;
    if corner == 0u || corner == 2u || corner == 4u { turn = -1.0; }
    // A little nearer than the faces that the line belongs to.
    return Stroke(vec4(end.xy + side * turn * end.w, end.z - 0.000004 * end.w, end.w), vec2(0.0), part, away);
}

@fragment
fn line_fragment(in: Stroke) -> @location(0) vec4<f32> {
    // A little beyond, so that the outline of a section is not cut off.
    if in.clipped > 0.01 {
        discard;
    }
    if u.line.w < 0.5 {
        return vec4(of_part(in.part, u.line.rgb), 1.0);
    }
    return vec4(u.line.rgb, 1.0);
}

@vertex
fn point_vertex(@builtin(vertex_index) corner: u32, @location(0) at: vec3<f32>) -> Stroke {
    let centre = u.matrix * vec4(at, 1.0);
    let x = select(-1.0, 1.0, corner == 1u || corner == 3u || corner == 4u);
    let y = select(-1.0, 1.0, corner == 2u || corner == 4u || corner == 5u);
    let place = vec2(x, y);
    let offset = place * u.pixels.w / u.pixels.xy * centre.w;
    return Stroke(vec4(centre.xy + offset, centre.z - 0.00001 * centre.w, centre.w), place, 0u, clipped(at));
}

@fragment
fn point_fragment(in: Stroke) -> @location(0) vec4<f32> {
    if dot(in.place, in.place) > 1.0 || in.clipped > 0.01 {
        discard;
    }
    return vec4(u.line.rgb, 1.0);
}

@group(1) @binding(0) var photo: texture_2d<f32>;
@group(1) @binding(1) var smooth_photo: sampler;

struct Photo {
    @builtin(position) at: vec4<f32>,
    @location(0) place: vec2<f32>,
    @location(1) clipped: f32,
}

// A picture on faces whose parts are its corners.
@vertex
fn photo_vertex(@location(0) at: vec3<f32>, @location(1) normal: vec4<f32>, @location(2) part: u32) -> Photo {
    let place = vec2(f32(part & 1u), f32((part >> 1u) & 1u));
    return Photo(u.matrix * vec4(at, 1.0), place, clipped(at));
}

@fragment
fn photo_fragment(in: Photo) -> @location(0) vec4<f32> {
    let colour = textureSample(photo, smooth_photo, in.place);
    if in.clipped > 0.0 || colour.a < 0.02 {
        discard;
    }
    return vec4(colour.rgb, 1.0);
}
