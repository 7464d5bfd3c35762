//! Pictures of a frame for files, of any size: what is too large is drawn in tiles.

use super::{Frame, Resources, Shown};
use eframe::egui_wgpu::wgpu::util::DeviceExt as _;
use eframe::egui_wgpu::{self, wgpu};
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

/// Most pixels of a picture: a gibibyte of memory.
const MOST_PIXELS: u64 = 1 << 28;
/// Larger pictures are drawn in tiles of this side, pixels.
const TILE: u32 = 2048;

/// A picture of a frame, `size` pixels; lines are as wide as at `scale` pixels per point. Rows of r, g, b, a bytes. What is
/// larger than the card can make, or than a moderate tile, is drawn in tiles.
///
/// # Errors
/// If it has no or too many pixels, or the card does not give it.
pub fn picture(state: &egui_wgpu::RenderState, frame: &Frame, size: [u32; 2], scale: f32) -> Result<Vec<u8>, String> {
    let [w, h] = size;
    if w == 0 || h == 0 || u64::from(w) * u64::from(h) > MOST_PIXELS {
        return Err(format!("{w} × {h} pixels: it may have 1 to {MOST_PIXELS}"));
    }
    let side = state.device.limits().max_texture_dimension_2d.min(TILE);
    let mut all = vec![0; w as usize * h as usize * 4];
    for y in (0..h).step_by(side as usize) {
        for x in (0..w).step_by(side as usize) {
            let part = [side.min(w - x), side.min(h - y)];
            let tile = Frame { matrix: window([x, y], part, size) * frame.matrix, ..frame.clone() };
            let bytes = tile_of(state, &tile, part, scale)?;
            for (row, from) in bytes.chunks_exact(part[0] as usize * 4).enumerate() {
                let at = ((y as usize + row) * w as usize + x as usize) * 4;
                all[at..at + from.len()].copy_from_slice(from);
            }
        }
    }
    Ok(all)
}

/// From the clip space of a whole picture to that of a part of it, pixels from the upper left corner.
fn window(at: [u32; 2], part: [u32; 2], whole: [u32; 2]) -> glam::DMat4 {
    let share = |k: usize| f64::from(part[k]) / f64::from(whole[k]);
    let middle = |k: usize| (2.0 * f64::from(at[k]) + f64::from(part[k])) / f64::from(whole[k]) - 1.0;
    let (sx, sy) = (1.0 / share(0), 1.0 / share(1));
    // Rows count down, clip space up.
    let shift = glam::DVec4::new(-middle(0) * sx, middle(1) * sy, 0.0, 1.0);
    glam::DMat4::from_cols(glam::DVec4::X * sx, glam::DVec4::Y * sy, glam::DVec4::Z, shift)
}

fn tile_of(state: &egui_wgpu::RenderState, frame: &Frame, size: [u32; 2], scale: f32) -> Result<Vec<u8>, String> {
    let (device, queue) = (&state.device, &state.queue);
    let mut encoder = device.create_command_encoder(&Default::default());
    let target = {
        // The window waits for this, but for nothing that follows.
        let mut renderer = state.renderer.write();
        let r = renderer.callback_resources.get_mut::<Resources>().ok_or("there is no viewport")?;
        frame.bring(device, queue, r);
        let seen = |shown: &Shown| {
            let b = r.buffers.get(&shown.key)?;
            let uniforms = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: None,
                contents: bytemuck::bytes_of(&frame.uniforms(shown, size, scale)),
                usage: wgpu::BufferUsages::UNIFORM,
            });
            Some((b, r.pipelines.group(device, &uniforms, &b.colour_buffer)))
        };
        let all: Vec<_> = frame.shown.iter().filter_map(seen).collect();
        let target = r.pipelines.target(device, size);
        frame.draw(&mut encoder, &target, &r.pipelines, all.iter().map(|(b, group)| (*b, group)));
        target
    };
    // Rows in a buffer begin at multiples of this.
    let row = (size[0] * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: u64::from(row) * u64::from(size[1]),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    encoder.copy_texture_to_buffer(
        target.picture.texture().as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
        },
        wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
    );
    queue.submit([encoder.finish()]);
    let (tell, told) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |done| drop(tell.send(done)));
    // Waiting inside of the card's library would keep the window from submitting its frames.
    loop {
        device.poll(wgpu::PollType::Poll).map_err(|e| e.to_string())?;
        match told.recv_timeout(Duration::from_millis(1)) {
            Ok(done) => break done.map_err(|e| e.to_string())?,
            Err(RecvTimeoutError::Timeout) => {}
            Err(e) => return Err(e.to_string()),
        }
    }
    let bytes = buffer.get_mapped_range(..).map_err(|e| e.to_string())?;
    let rows = bytes.chunks_exact(row as usize).flat_map(|r| &r[..size[0] as usize * 4]);
    Ok(rows.copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, DVec4};

    #[test]
    fn a_tile_shows_its_part_of_the_picture() {
        let m = window([100, 50], [100, 50], [400, 200]);
        // The tile's upper left corner is at (100, 50) of 400 × 200 pixels.
        let corner = DVec4::new(-0.5, 0.5, 0.3, 1.0) * 2.0;
        assert!((m * corner / 2.0).truncate().distance(DVec3::new(-1.0, 1.0, 0.3)) < 1e-12);
        let other = DVec4::new(0.0, 0.0, 0.3, 1.0);
        assert!((m * other).truncate().distance(DVec3::new(1.0, -1.0, 0.3)) < 1e-12);
        assert_eq!(window([0, 0], [8, 8], [8, 8]), glam::DMat4::IDENTITY);
    }
}
