//! The graphics card: pipelines, and the picture with depth and smoothed edges that is made
//! before the window is painted and put into it afterwards.

mod buffers;
mod tiles;

pub use buffers::write_directly;
pub use tiles::picture;

use super::{Camera, Clip, rgb};
use crate::scene::{Drawing, Line, Vertex};
use buffers::Buffers;
use eframe::egui::{Color32, Rect};
use eframe::egui_wgpu::wgpu::util::DeviceExt as _;
use eframe::egui_wgpu::{self, CallbackResources, CallbackTrait, ScreenDescriptor, wgpu};
use std::collections::HashMap;
use std::sync::Arc;

const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const SAMPLES: u32 = 4;

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Uniforms {
    matrix: [[f32; 4]; 4],
    face: [f32; 4],
    line: [f32; 4],
    eye: [f32; 4],
    pixels: [f32; 4],
    clip: [f32; 4],
}

/// One drawing and its colours.
#[derive(Clone)]
pub struct Shown {
    /// Under which name its buffers are kept.
    pub key: String,
    /// What is drawn.
    pub drawing: Arc<Drawing>,
    /// Colour of faces.
    pub face: [f32; 3],
    /// Colour of lines and points.
    pub line: [f32; 3],
    /// Width of lines and size of points, points of the screen.
    pub width: [f32; 2],
    /// Colours per part as bytes r, g, b, 255; 0: that of faces. Empty: all that.
    pub colours: Arc<Vec<u32>>,
    /// Both sides of faces are lit.
    pub open: bool,
    /// Lines bear the colours of their parts.
    pub coloured_lines: bool,
    /// It is cut by the frame's plane.
    pub clipped: bool,
    /// From the drawing's coordinates to the model's: turned, moved, and scaled alike in all directions.
    pub place: glam::DMat4,
    /// What is seen on its faces, whose parts are corners then: 0 to 3 from the picture's first row, left to right.
    pub picture: Option<Arc<Picture>>,
}

/// A picture to be laid on faces.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Rows of r, g, b, a bytes, the uppermost first.
    pub bytes: Vec<u8>,
}

/// What is to be drawn in one frame.
#[derive(Clone)]
pub struct Frame {
    /// From the model to clip space.
    pub matrix: glam::DMat4,
    /// Direction to the eye.
    pub eye: glam::DVec3,
    /// Size, points of the screen.
    pub size: [f32; 2],
    /// Colour of the ground.
    pub ground: [f32; 3],
    /// Normal and distance of the plane in front of which nothing is drawn; all 0 for none.
    pub clip: [f32; 4],
    /// What is drawn.
    pub shown: Vec<Shown>,
}

/// The picture that is drawn into.
struct Target {
    size: [u32; 2],
    smooth: wgpu::TextureView,
    depth: wgpu::TextureView,
    picture: wgpu::TextureView,
    group: wgpu::BindGroup,
}

struct Pipelines {
    layout: wgpu::BindGroupLayout,
    faces: wgpu::RenderPipeline,
    lines: wgpu::RenderPipeline,
    points: wgpu::RenderPipeline,
    edges: wgpu::RenderPipeline,
    corner_layout: wgpu::BindGroupLayout,
    photos: wgpu::RenderPipeline,
    photo_layout: wgpu::BindGroupLayout,
    smooth: wgpu::Sampler,
    blit: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
}

struct Resources {
    pipelines: Pipelines,
    buffers: HashMap<String, Buffers>,
    target: Option<Target>,
}

/// Prepares the graphics card; says what it is.
pub fn install(state: &egui_wgpu::RenderState) -> String {
    let pipelines = Pipelines::new(&state.device, state.target_format);
    let resources = Resources { pipelines, buffers: HashMap::new(), target: None };
    state.renderer.write().callback_resources.insert(resources);
    let info = state.adapter.get_info();
    let software = if info.device_type == wgpu::DeviceType::Cpu { ", drawn by the processor" } else { "" };
    format!("{}{software}", info.name)
}

impl Pipelines {
    fn new(device: &wgpu::Device, window: wgpu::TextureFormat) -> Self {
        let shader = |label, text: &str| {
            let source = wgpu::ShaderSource::Wgsl(text.into());
            device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(label), source })
        };
        let (scene, blit) = (shader("scene", include_str!("shader.wgsl")), shader("blit", include_str!("blit.wgsl")));
        let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("drawing"),
            entries: &[
                entry(0, wgpu::ShaderStages::VERTEX_FRAGMENT, wgpu::BufferBindingType::Uniform),
                entry(1, wgpu::ShaderStages::FRAGMENT, storage),
            ],
        });
        let common = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("scene"),
            bind_group_layouts: &[Some(&layout)],
            ..Default::default()
        });
        let visibility = wgpu::ShaderStages::FRAGMENT;
        let photo_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("photo"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                },
                wgpu::BindGroupLayoutEntry {
                    binding: 1,
                    visibility,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
            ],
        });
        let corner_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("corners"),
            entries: &[entry(2, wgpu::ShaderStages::VERTEX, storage)],
        });
        let with_corners = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("scene with corners"),
            bind_group_layouts: &[Some(&layout), Some(&corner_layout)],
            ..Default::default()
        });
        let with_photo = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("scene with photo"),
            bind_group_layouts: &[Some(&layout), Some(&photo_layout)],
            ..Default::default()
        });
        let face = wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm8x4, 2 => Uint32];
        let line = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Uint32];
        let point = wgpu::vertex_attr_array![0 => Float32x3];
        let edge = wgpu::vertex_attr_array![0 => Uint16x2];
        let pipeline = |name: &str, stride: u64, step_mode, attributes: &[wgpu::VertexAttribute]| {
            let layout = match name {
                "photo" => &with_photo,
                "edge" => &with_corners,
                _ => &common,
            };
            // Edges are lines that find their ends elsewhere.
            let fragment = if name == "edge" { "line" } else { name };
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(name),
                layout: Some(layout),
                vertex: wgpu::VertexState {
                    module: &scene,
                    entry_point: Some(&format!("{name}_vertex")),
                    compilation_options: Default::default(),
                    buffers: &[Some(wgpu::VertexBufferLayout { array_stride: stride, step_mode, attributes })],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::LessEqual),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &scene,
                    entry_point: Some(&format!("{fragment}_fragment")),
                    compilation_options: Default::default(),
                    targets: &[Some(COLOUR.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let blit = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("blit"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &blit,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &blit,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &[Some(window.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self {
            faces: pipeline("face", size_of::<Vertex>() as u64, wgpu::VertexStepMode::Vertex, &face),
            lines: pipeline("line", size_of::<Line>() as u64, wgpu::VertexStepMode::Instance, &line),
            points: pipeline("point", 12, wgpu::VertexStepMode::Instance, &point),
            photos: pipeline("photo", size_of::<Vertex>() as u64, wgpu::VertexStepMode::Vertex, &face),
            edges: pipeline("edge", 4, wgpu::VertexStepMode::Instance, &edge),
            corner_layout,
            photo_layout,
            smooth: device.create_sampler(&wgpu::SamplerDescriptor {
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            sampler: device.create_sampler(&Default::default()),
            layout,
            blit,
        }
    }

    fn target(&self, device: &wgpu::Device, size: [u32; 2]) -> Target {
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let view = |format, sample_count, usage| {
            let size = wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 };
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size,
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            });
            texture.create_view(&Default::default())
        };
        let copied = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let picture = view(COLOUR, 1, attachment | copied);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.blit.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&picture) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.sampler) },
            ],
        });
        Target {
            size,
            smooth: view(COLOUR, SAMPLES, attachment),
            depth: view(DEPTH, SAMPLES, attachment),
            picture,
            group,
        }
    }

    /// A picture as the card takes it.
    fn photo(&self, device: &wgpu::Device, queue: &wgpu::Queue, picture: &Picture) -> wgpu::BindGroup {
        let descriptor = wgpu::TextureDescriptor {
            label: Some("photo"),
            size: wgpu::Extent3d { width: picture.size[0], height: picture.size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: COLOUR,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let order = wgpu::util::TextureDataOrder::LayerMajor;
        let view =
            device.create_texture_with_data(queue, &descriptor, order, &picture.bytes).create_view(&Default::default());
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.photo_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.smooth) },
            ],
        })
    }

    fn group(&self, device: &wgpu::Device, uniforms: &wgpu::Buffer, colours: &wgpu::Buffer) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: colours.as_entire_binding() },
            ],
        })
    }
}

impl Shown {
    /// A drawing in one colour for faces and one for lines.
    pub fn plain(key: String, drawing: Arc<Drawing>, face: Color32, line: Color32) -> Self {
        Self {
            key,
            drawing,
            face: rgb(face),
            line: rgb(line),
            width: [1.0, 4.0],
            colours: Arc::default(),
            open: false,
            coloured_lines: false,
            clipped: false,
            place: glam::DMat4::IDENTITY,
            picture: None,
        }
    }
}

impl Frame {
    /// What an eye sees in a rectangle of the window.
    pub fn new(camera: &Camera, area: Rect, ground: Color32, clip: Option<Clip>, shown: Vec<Shown>) -> Self {
        let aspect = f64::from(area.width().max(1.0) / area.height().max(1.0));
        Self {
            matrix: camera.matrix(aspect),
            eye: camera.back(),
            size: [area.width(), area.height()],
            ground: rgb(ground),
            clip: clip.map_or([0.0; 4], Clip::plane),
            shown,
        }
    }

    fn uniforms(&self, shown: &Shown, size: [u32; 2], scale: f32) -> Uniforms {
        // The eye and the plane as the drawing's own coordinates have them.
        let back = glam::DMat3::from_mat4(shown.place).transpose();
        let [x, y, z] = (back * self.eye).normalize_or_zero().as_vec3().to_array();
        let [nx, ny, nz, off] = self.clip.map(f64::from);
        let normal = glam::DVec3::new(nx, ny, nz);
        let [cx, cy, cz] = (back * normal).as_vec3().to_array();
        let clip = [cx, cy, cz, (off + normal.dot(shown.place.w_axis.truncate())) as f32];
        let four = |[r, g, b]: [f32; 3]| [r, g, b, 1.0];
        Uniforms {
            matrix: (self.matrix * shown.place).as_mat4().to_cols_array_2d(),
            face: four(shown.face),
            line: [shown.line[0], shown.line[1], shown.line[2], if shown.coloured_lines { 0.0 } else { 1.0 }],
            eye: [x, y, z, if shown.open { 1.0 } else { 0.0 }],
            pixels: [size[0] as f32, size[1] as f32, shown.width[0] * scale, shown.width[1] * scale],
            clip: if shown.clipped { clip } else { [0.0; 4] },
        }
    }
}

impl CallbackTrait for Frame {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let Some(r) = resources.get_mut::<Resources>() else { return Vec::new() };
        let most = device.limits().max_texture_dimension_2d;
        let size = self.size.map(|s| ((s * screen.pixels_per_point).round() as u32).clamp(1, most));
        if r.target.as_ref().is_none_or(|t| t.size != size) {
            r.target = Some(r.pipelines.target(device, size));
        }
        r.buffers.retain(|key, _| self.shown.iter().any(|s| s.key == *key));
        self.bring(device, queue, r);
        for (shown, b) in self.shown.iter().filter_map(|s| Some((s, r.buffers.get(&s.key)?))) {
            let uniforms = self.uniforms(shown, size, screen.pixels_per_point);
            queue.write_buffer(&b.uniforms, 0, bytemuck::bytes_of(&uniforms));
        }
        if let Some(target) = &r.target {
            let all = self.shown.iter().filter_map(|s| r.buffers.get(&s.key));
            self.draw(encoder, target, &r.pipelines, all.map(|b| (b, &b.group)));
        }
        Vec::new()
    }

    fn paint(
        &self,
        _: eframe::egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        let Some(r) = resources.get::<Resources>() else { return };
        let Some(target) = &r.target else { return };
        pass.set_pipeline(&r.pipelines.blit);
        pass.set_bind_group(0, &target.group, &[]);
        pass.draw(0..3, 0..1);
    }
}

impl Frame {
    /// Brings buffers up to what is to be drawn.
    fn bring(&self, device: &wgpu::Device, queue: &wgpu::Queue, r: &mut Resources) {
        for shown in &self.shown {
            let fresh = r.buffers.get(&shown.key).is_some_and(|b| {
                b.digest == shown.drawing.digest
                    && (Arc::ptr_eq(&b.colours, &shown.colours) || b.colours == shown.colours)
            });
            if !fresh {
                r.buffers.insert(shown.key.clone(), r.pipelines.buffers(device, queue, shown));
            }
        }
    }

    /// Draws into a target: buffers, each with how it is seen.
    fn draw<'a>(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &Target,
        pipelines: &Pipelines,
        all: impl Iterator<Item = (&'a Buffers, &'a wgpu::BindGroup)>,
    ) {
        let [red, green, blue] = self.ground.map(f64::from);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("viewport"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.smooth,
                resolve_target: Some(&target.picture),
                depth_slice: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r: red, g: green, b: blue, a: 1.0 }),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &target.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        for (b, group) in all {
            pass.set_bind_group(0, group, &[]);
            match &b.photo {
                Some(photo) => {
                    pass.set_pipeline(&pipelines.photos);
                    pass.set_bind_group(1, photo, &[]);
                }
                None => pass.set_pipeline(&pipelines.faces),
            }
            for (buffer, count) in &b.triangles {
                pass.set_vertex_buffer(0, buffer.slice(..));
                pass.draw(0..*count, 0..1);
            }
            for body in &b.bodies {
                if body.triangles.1 > 0 {
                    pass.set_pipeline(&pipelines.faces);
                    pass.set_vertex_buffer(0, body.vertices.slice(..));
                    pass.set_index_buffer(body.triangles.0.slice(..), wgpu::IndexFormat::Uint16);
                    pass.draw_indexed(0..body.triangles.1, 0, 0..1);
                }
                if body.edges.1 > 0 {
                    pass.set_pipeline(&pipelines.edges);
                    pass.set_bind_group(1, &body.corners, &[]);
                    pass.set_vertex_buffer(0, body.edges.0.slice(..));
                    pass.draw(0..6, 0..body.edges.1);
                }
            }
            for (pipeline, all) in [(&pipelines.lines, &b.lines), (&pipelines.points, &b.points)] {
                pass.set_pipeline(pipeline);
                for (buffer, count) in all {
                    pass.set_vertex_buffer(0, buffer.slice(..));
                    pass.draw(0..6, 0..*count);
                }
            }
        }
    }
}
