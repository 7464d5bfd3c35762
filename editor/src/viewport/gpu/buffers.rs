//! The memory of the card: how what is drawn comes into it.

use super::{Pipelines, Shown, Uniforms};
use crate::scene::{Bodies, Line, Vertex};
use eframe::egui_wgpu::{self, wgpu};
use rayon::prelude::*;
use std::sync::Arc;

/// Largest buffer, bytes: a multiple of three corners and of a line.
const CHUNK: usize = 60 * 28 * 5_000;

/// Buffers of one drawing.
pub(super) struct Buffers {
    pub digest: u128,
    pub colours: Arc<Vec<u32>>,
    pub colour_buffer: wgpu::Buffer,
    pub triangles: Vec<(wgpu::Buffer, u32)>,
    pub lines: Vec<(wgpu::Buffer, u32)>,
    pub points: Vec<(wgpu::Buffer, u32)>,
    pub bodies: Vec<BodyBuffers>,
    /// How it is seen in the window; a picture has uniforms of its own.
    pub uniforms: wgpu::Buffer,
    pub group: wgpu::BindGroup,
    pub photo: Option<wgpu::BindGroup>,
}

/// Buffers of a piece of bodies.
pub(super) struct BodyBuffers {
    pub vertices: wgpu::Buffer,
    pub triangles: (wgpu::Buffer, u32),
    pub edges: (wgpu::Buffer, u32),
    /// The vertices as edges see them.
    pub corners: wgpu::BindGroup,
}

/// Has an adapter that is the processor itself take buffers as they are written, in memory that both see. Cards take copies:
/// their own memory is faster for them.
pub fn write_directly(setup: &mut egui_wgpu::WgpuSetup) {
    let egui_wgpu::WgpuSetup::CreateNew(new) = setup else { return };
    let before = new.device_descriptor.clone();
    new.device_descriptor = Arc::new(move |adapter| {
        let mut device = before(adapter);
        if adapter.get_info().device_type == wgpu::DeviceType::Cpu {
            device.required_features |= adapter.features() & wgpu::Features::MAPPABLE_PRIMARY_BUFFERS;
        }
        device
    });
}

/// A buffer with that in it, whose size is rounded up to a multiple of four.
fn written(device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let direct = device.features().contains(wgpu::Features::MAPPABLE_PRIMARY_BUFFERS);
    let way = if direct { wgpu::BufferUsages::MAP_WRITE } else { wgpu::BufferUsages::COPY_DST };
    let whole = bytes.len() as u64 / 4 * 4;
    let size = (bytes.len() as u64).next_multiple_of(4);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size,
        usage: usage | way,
        mapped_at_creation: direct,
    });
    if direct {
        if let Ok(mut there) = buffer.get_mapped_range_mut(..) {
            there.slice(..bytes.len()).copy_from_slice(bytes);
        }
        buffer.unmap();
        return buffer;
    }
    // By the queue: one that is mapped at its creation without being seen by both is filled with zeros and copied.
    let (body, rest) = bytes.split_at(whole as usize);
    queue.write_buffer(&buffer, 0, body);
    if !rest.is_empty() {
        let mut last = [0; 4];
        last[..rest.len()].copy_from_slice(rest);
        queue.write_buffer(&buffer, whole, &last);
    }
    buffer
}

impl Pipelines {
    /// Brings a drawing to the card.
    pub(super) fn buffers(&self, device: &wgpu::Device, queue: &wgpu::Queue, shown: &Shown) -> Buffers {
        // On all threads: what takes time is the copy into memory that the card sees.
        let written = |bytes: &[u8], usage| written(device, queue, bytes, usage);
        let vertex = wgpu::BufferUsages::VERTEX;
        let chunks = |bytes: &[u8], item: usize| -> Vec<(wgpu::Buffer, u32)> {
            bytes.par_chunks(CHUNK).map(|c| (written(c, vertex), (c.len() / item) as u32)).collect()
        };
        let body = |b: &Bodies| {
            let vertices = written(bytemuck::cast_slice(&b.vertices), vertex | wgpu::BufferUsages::STORAGE);
            let corners = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &self.corner_layout,
                entries: &[wgpu::BindGroupEntry { binding: 2, resource: vertices.as_entire_binding() }],
            });
            let triangles = written(bytemuck::cast_slice(&b.triangles), wgpu::BufferUsages::INDEX);
            let edges = written(bytemuck::cast_slice(&b.edges), vertex);
            let counts = [b.triangles.len(), b.edges.len()].map(|n| n as u32);
            BodyBuffers { vertices, triangles: (triangles, counts[0]), edges: (edges, counts[1]), corners }
        };
        let d = &shown.drawing;
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: size_of::<Uniforms>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let none = [0_u32];
        let colours: &[u32] = if shown.colours.is_empty() { &none } else { &shown.colours };
        // The last colour counts for all parts beyond it, so one zero is enough for none.
        let colour_buffer = written(bytemuck::cast_slice(colours), wgpu::BufferUsages::STORAGE);
        let group = self.group(device, &uniforms, &colour_buffer);
        Buffers {
            digest: d.digest,
            colours: shown.colours.clone(),
            colour_buffer,
            triangles: match d.bodies.is_empty() {
                true => chunks(bytemuck::cast_slice(&d.triangles), size_of::<Vertex>()),
                false => Vec::new(),
            },
            bodies: d.bodies.par_iter().filter(|b| !b.vertices.is_empty()).map(body).collect(),
            lines: chunks(bytemuck::cast_slice(&d.lines), size_of::<Line>()),
            points: chunks(bytemuck::cast_slice(&d.points), 12),
            uniforms,
            group,
            photo: shown.picture.as_ref().map(|p| self.photo(device, queue, p)),
        }
    }
}
