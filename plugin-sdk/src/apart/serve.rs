//! The plugin's process: it loads the library, says what it brings, and evaluates what it is asked to until its host is gone.

use super::memory::Memory;
use super::wire::{Garbled, Put, Take, Wire};
use crate::load::{EvaluateError, Message, NodeInfo, Plugin, Sink, Watch};
use crate::value::Branch;
use std::convert::Infallible;
use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::{AsFd, AsRawFd};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::atomic::Ordering;

/// Marks of what a process is asked.
pub(super) const EVALUATE: u8 = 0;
pub(super) const MIGRATE: u8 = 1;

/// Marks of what a process says while it evaluates.
pub(super) const TOLD: u8 = 1;
pub(super) const SET: u8 = 2;
pub(super) const FORWARDED: u8 = 3;
pub(super) const ENDED: u8 = 0;

/// How an evaluation ended, as a number.
pub(super) const WELL: u8 = 0;
pub(super) const CANCELLED: u8 = 1;
pub(super) const FAILED: u8 = 2;
pub(super) const FAULT: u8 = 3;

/// Reads a message: its length, then its bytes.
pub(super) fn receive(from: &mut impl Read, bytes: &mut Vec<u8>) -> io::Result<()> {
    let mut length = [0; 8];
    from.read_exact(&mut length)?;
    bytes.clear();
    let length = u64::from_le_bytes(length);
    let read = from.take(length).read_to_end(bytes)?;
    if read as u64 == length { Ok(()) } else { Err(io::ErrorKind::UnexpectedEof.into()) }
}

/// Writes a message.
pub(super) fn send(to: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    let mut all = Vec::with_capacity(8 + bytes.len());
    all.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
    all.extend_from_slice(bytes);
    to.write_all(&all)
}

/// Serves the host whose socket is the standard input and whose shared memory is the standard output.
pub(super) fn serve(library: &Path, memory: u64) -> Result<Infallible, String> {
    let stranger = |_| "tenon plugin host is started by tenon, not by people".to_owned();
    let socket = io::stdin().as_fd().try_clone_to_owned().map_err(stranger)?;
    let shared = File::from(io::stdout().as_fd().try_clone_to_owned().map_err(stranger)?);
    let shared = Memory::of(shared).map_err(stranger)?;
    let mut socket = UnixStream::from(socket);
    socket.peer_addr().map_err(stranger)?;
    // What a plugin prints goes where people read it, and it has nothing to read.
    let nothing = File::open("/dev/null").map_err(|e| e.to_string())?;
    // SAFETY: these numbers are open files; nobody here holds 0 or 1 as their own.
    if unsafe { libc::dup2(nothing.as_raw_fd(), 0) < 0 || libc::dup2(2, 1) < 0 } {
        return Err(io::Error::last_os_error().to_string());
    }
    end_with_host(&socket).map_err(|e| e.to_string())?;
    limit(memory);
    let plugin = Plugin::load(library);
    let mut put = Put::new(&shared);
    match &plugin {
        Ok(plugin) => {
            true.put(&mut put);
            [&plugin.id, &plugin.version, &plugin.vendor, &plugin.doc].into_iter().for_each(|text| text.put(&mut put));
            plugin.nodes.len().put(&mut put);
            plugin.nodes.iter().for_each(|node| NodeInfo::put(node, &mut put));
        }
        Err(why) => {
            false.put(&mut put);
            why.why.to_string().put(&mut put);
        }
    }
    let told = send(&mut socket, &put.bytes);
    if let (Ok(plugin), Ok(())) = (plugin, told) {
        // An error here means that the host is gone.
        let _ = answer(&plugin, &shared, socket, memory);
    }
    // SAFETY: ends the process, leaving out what the library has hung up for its end.
    unsafe { libc::_exit(0) }
}

/// Answers until the host hangs up.
fn answer(plugin: &Plugin, shared: &Memory, mut socket: UnixStream, memory: u64) -> io::Result<Infallible> {
    let mut asked = Vec::new();
    loop {
        receive(&mut socket, &mut asked)?;
        let reply = match asked.split_first() {
            Some((&EVALUATE, asked)) => evaluate(plugin, shared, asked, memory),
            Some((&MIGRATE, asked)) => migrate(plugin, shared, asked),
            _ => Err(Garbled::Short),
        };
        send(&mut socket, &reply.map_err(io::Error::other)?)?;
    }
}

fn evaluate(plugin: &Plugin, shared: &Memory, asked: &[u8], memory: u64) -> Result<Vec<u8>, Garbled> {
    let mut take = Take::in_place(asked, shared);
    let (index, top) = (u32::take(&mut take)?, u64::take(&mut take)?);
    let inputs = Vec::<Vec<Branch<'_>>>::take(&mut take)?;
    let node = plugin.nodes.get(index as usize).ok_or(Garbled::Short)?;
    shared.set_top(top);
    shared.limit(memory);
    let header = shared.header();
    let mut replies = Replies { put: Put::new(shared), inputs: inputs.len() };
    let ended = node.evaluate(
        &inputs,
        Watch {
            cancelled: &|| header.cancel.load(Ordering::Relaxed) != 0,
            progress: &|fraction| {
                // Fractions that are not negative rise as their bits do; the sum makes -0 be 0.
                let fraction = fraction + 0.0;
                if fraction.to_bits() > header.progress.load(Ordering::Relaxed) {
                    header.progress.store(fraction.to_bits(), Ordering::Relaxed);
                    header.beats.fetch_add(1, Ordering::Relaxed);
                }
            },
            refuse_buffer: None,
            room: Some(&|bytes| shared.zeroed(bytes)),
        },
        &mut replies,
    );
    let mut put = replies.put;
    put.bytes.push(ENDED);
    let (mark, why) = match ended {
        Ok(()) if put.full => (FAULT, "there is no room for its outputs".to_owned()),
        Ok(()) => (WELL, String::new()),
        Err(EvaluateError::Cancelled) => (CANCELLED, String::new()),
        Err(EvaluateError::Failed) => (FAILED, String::new()),
        Err(EvaluateError::Fault(why) | EvaluateError::Died(why)) => (FAULT, why),
    };
    put.bytes.push(mark);
    why.put(&mut put);
    Ok(put.bytes)
}

fn migrate(plugin: &Plugin, shared: &Memory, asked: &[u8]) -> Result<Vec<u8>, Garbled> {
    let mut take = Take::in_place(asked, shared);
    let (index, from) = (u32::take(&mut take)?, u32::take(&mut take)?);
    let node = plugin.nodes.get(index as usize).ok_or(Garbled::Short)?;
    let done = node.migrate(from, &String::take(&mut take)?);
    let mut put = Put::new(shared);
    done.is_ok().put(&mut put);
    done.unwrap_or_else(|why| why).put(&mut put);
    Ok(put.bytes)
}

/// Writes down what the plugin gives, in order.
struct Replies<'m> {
    put: Put<'m>,
    inputs: usize,
}

impl Sink for Replies<'_> {
    fn set(&mut self, output: u32, value: Vec<Branch<'_>>) -> Result<(), String> {
        self.put.bytes.push(SET);
        output.put(&mut self.put);
        value.put(&mut self.put);
        Ok(())
    }

    fn forward(&mut self, output: u32, input: u32) -> Result<(), String> {
        if input as usize >= self.inputs {
            return Err(format!("there is no input {input}"));
        }
        self.put.bytes.push(FORWARDED);
        output.put(&mut self.put);
        input.put(&mut self.put);
        Ok(())
    }

    fn tell(&mut self, message: Message) {
        self.put.bytes.push(TOLD);
        message.put(&mut self.put);
    }
}

/// Ends this process when its host ends, whatever the plugin does meanwhile.
fn end_with_host(socket: &UnixStream) -> io::Result<()> {
    let socket = socket.try_clone()?;
    let wait = move || {
        let mut ear = libc::pollfd { fd: socket.as_raw_fd(), events: libc::POLLRDHUP, revents: 0 };
        loop {
            // SAFETY: one entry, which lives through the call.
            let heard = unsafe { libc::poll(&raw mut ear, 1, -1) };
            if heard > 0 && ear.revents != 0 {
                // SAFETY: ends the process.
                unsafe { libc::_exit(0) }
            }
        }
    };
    std::thread::Builder::new().stack_size(64 << 10).spawn(wait).map(drop)
}

/// Lets this process take so much memory more than it has, and leave no core files. A limit that the system refuses is
/// left out.
fn limit(memory: u64) {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let taken = status.lines().find_map(|l| l.strip_prefix("VmData:")?.trim().strip_suffix(" kB")?.parse::<u64>().ok());
    let most = memory.saturating_add(taken.unwrap_or(0) << 10);
    for (what, most) in [(libc::RLIMIT_DATA, most), (libc::RLIMIT_CORE, 0)] {
        let limit = libc::rlimit { rlim_cur: most, rlim_max: most };
        // SAFETY: the struct lives through the call.
        unsafe { libc::setrlimit(what, &raw const limit) };
    }
}
