//! The host's side: processes that are started, asked, watched, and buried.

use super::memory::Memory;
use super::serve::{CANCELLED, ENDED, EVALUATE, FAILED, FORWARDED, MIGRATE, SET, TOLD, WELL, send};
use super::wire::{Garbled, Put, Take, Wire};
use super::{Limits, Program};
use crate::load::{EvaluateError, LoadError, LoadFault, Message, Plugin, PluginInfo, Sink, Watch};
use crate::value::Branch;
use std::io::{self, Read};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How often a process that works is looked at.
const GLANCE: Duration = Duration::from_millis(20);
/// How long a process may take to begin, however little its evaluations may: the system may have other things to do.
const BIRTH: Duration = Duration::from_secs(10);
/// How long one that was asked to stop may go on.
const GRACE: Duration = Duration::from_secs(1);
/// Processes whose shared memory grew beyond this are not kept.
const KEPT: u64 = 1 << 30;

/// The processes of one plugin.
#[derive(Debug)]
pub(crate) struct Processes {
    library: PathBuf,
    program: Program,
    limits: Limits,
    idle: Mutex<Vec<Process>>,
}

#[derive(Debug)]
struct Process {
    id: libc::pid_t,
    socket: UnixStream,
    shared: Memory,
}

/// Nobody waits or hears of progress.
const ALONE: Watch<'static> = Watch { cancelled: &|| false, progress: &|_| (), refuse_buffer: None, room: None };

/// What the host does not get an answer for.
enum Silence {
    /// It was asked to stop.
    Cancelled,
    /// Why there is none.
    Died(String),
}

pub(super) fn start(library: &Path, program: &Program, limits: Limits) -> Result<Plugin, LoadError> {
    let fail = |why| LoadError { path: library.to_owned(), why };
    let full = library.canonicalize().map_err(|e| fail(LoadFault::System(e.to_string())))?;
    let processes = Processes { library: full.clone(), program: program.clone(), limits, idle: Mutex::default() };
    let (process, told) = processes.begin().map_err(|why| fail(LoadFault::Process(why)))?;
    let mut take = Take::copied(&told, &process.shared);
    let mut read = || -> Result<Result<PluginInfo, String>, Garbled> {
        if bool::take(&mut take)? { PluginInfo::take(&mut take).map(Ok) } else { String::take(&mut take).map(Err) }
    };
    let info = match read() {
        Ok(Ok(info)) => info,
        Ok(Err(why)) => return Err(fail(LoadFault::NotAPlugin(why))),
        Err(why) => return Err(fail(LoadFault::Process(why.to_string()))),
    };
    processes.rest(process);
    Ok(Plugin::apart(full, info, &Arc::new(processes)))
}

impl Processes {
    /// Starts a process; what it says of itself comes with it, or why it is not there.
    fn begin(&self) -> Result<(Process, Vec<u8>), String> {
        let failed = |e: io::Error| format!("its process cannot be started: {e}");
        let shared = Memory::new().map_err(failed)?;
        let (socket, theirs) = UnixStream::pair().map_err(failed)?;
        let child = Command::new(&self.program.path)
            .args(&self.program.arguments)
            .arg(&self.library)
            .arg(self.limits.memory.to_string())
            .stdin(Stdio::from(OwnedFd::from(theirs)))
            .stdout(Stdio::from(shared.file().try_clone().map_err(failed)?))
            // A Ctrl-C in a terminal is the host's to handle.
            .process_group(0)
            .spawn()
            .map_err(failed)?;
        let id = libc::pid_t::try_from(child.id()).map_err(|e| e.to_string())?;
        let mut process = Process { id, socket, shared };
        process.socket.set_read_timeout(Some(GLANCE)).map_err(failed)?;
        process.socket.set_write_timeout(Some(self.limits.time)).map_err(failed)?;
        let limits = Limits { time: self.limits.time.max(BIRTH), ..self.limits };
        match process.listen(ALONE, &limits) {
            Ok(told) => Ok((process, told)),
            Err(Silence::Died(why)) => Err(why),
            Err(Silence::Cancelled) => Err("it was cancelled".into()),
        }
    }

    /// Keeps a process for the next evaluation.
    fn rest(&self, process: Process) {
        if process.shared.len() <= KEPT {
            self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(process);
        }
    }

    /// One that is alive.
    fn wake(&self) -> Result<Process, String> {
        loop {
            let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
            let Some(mut process) = idle else { return self.begin().map(|(process, _)| process) };
            if process.bury(libc::WNOHANG).is_none() {
                return Ok(process);
            }
        }
    }

    /// Evaluates node `index`.
    pub(crate) fn evaluate(
        &self,
        index: u32,
        inputs: &[Vec<Branch<'_>>],
        watch: Watch<'_>,
        sink: &mut dyn Sink,
    ) -> Result<(), EvaluateError> {
        let mut process = self.wake().map_err(EvaluateError::Died)?;
        let reply = process.ask(index, inputs).and_then(|()| process.listen(watch, &self.limits));
        let reply = match reply {
            Ok(reply) => reply,
            Err(Silence::Cancelled) => return Err(EvaluateError::Cancelled),
            Err(Silence::Died(why)) => return Err(EvaluateError::Died(why)),
        };
        let ended = process.read(&reply, sink);
        self.rest(process);
        match ended {
            Ok(Err(EvaluateError::Cancelled)) if !(watch.cancelled)() => {
                Err(EvaluateError::Fault("it gave up although nobody asked it to".into()))
            }
            Ok(ended) => ended,
            Err(garbled) => Err(EvaluateError::Fault(garbled.to_string())),
        }
    }
}

impl Processes {
    /// Brings a node forward.
    pub(crate) fn migrate(&self, index: u32, from: u32, node: &str) -> Result<String, String> {
        let mut process = self.wake()?;
        let mut put = Put::new(&process.shared);
        put.bytes.push(MIGRATE);
        index.put(&mut put);
        from.put(&mut put);
        node.to_owned().put(&mut put);
        let asked = put.bytes;
        let _ = send(&mut process.socket, &asked);
        let reply = match process.listen(ALONE, &self.limits) {
            Ok(reply) => reply,
            Err(Silence::Died(why)) => return Err(format!("the plugin died: {why}")),
            Err(Silence::Cancelled) => return Err("it was cancelled".into()),
        };
        let mut take = Take::copied(&reply, &process.shared);
        let done = bool::take(&mut take).and_then(|well| Ok((well, String::take(&mut take)?)));
        self.rest(process);
        match done {
            Ok((true, text)) => Ok(text),
            Ok((false, why)) => Err(why),
            Err(garbled) => Err(garbled.to_string()),
        }
    }
}

impl Process {
    /// Sends a request.
    fn ask(&mut self, index: u32, inputs: &[Vec<Branch<'_>>]) -> Result<(), Silence> {
        let header = self.shared.header();
        header.cancel.store(0, Ordering::Relaxed);
        header.progress.store(0, Ordering::Relaxed);
        self.shared.reset();
        let mut values = Put::new(&self.shared);
        inputs.len().put(&mut values);
        inputs.iter().for_each(|input| input.put(&mut values));
        if values.full {
            return Err(Silence::Died("there is no room for its inputs in shared memory".into()));
        }
        let mut put = Put::new(&self.shared);
        put.bytes.push(EVALUATE);
        index.put(&mut put);
        self.shared.top().put(&mut put);
        put.bytes.append(&mut values.bytes);
        // A process that is gone shows when its answer does not come.
        let _ = send(&mut self.socket, &put.bytes);
        Ok(())
    }

    /// Waits for an answer: passes progress on and the wish to stop, and keeps to the limits.
    fn listen(&mut self, watch: Watch<'_>, limits: &Limits) -> Result<Vec<u8>, Silence> {
        let (mut bytes, mut piece) = (Vec::new(), [0; 1 << 14]);
        let (mut alive, mut stopping, mut beats) = (Instant::now(), None::<Instant>, None);
        loop {
            match self.socket.read(&mut piece) {
                Ok(0) => return Err(self.death(limits, stopping.is_some())),
                Ok(n) => bytes.extend_from_slice(&piece[..n]),
                Err(e) if matches!(e.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {}
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(_) => return Err(self.death(limits, stopping.is_some())),
            }
            if let Some((length, rest)) = bytes.split_first_chunk::<8>()
                && rest.len() as u64 >= u64::from_le_bytes(*length)
            {
                bytes.drain(..8);
                return Ok(bytes);
            }
            let header = self.shared.header();
            let beat = header.beats.load(Ordering::Relaxed);
            if beats.is_some_and(|last| last != beat) {
                alive = Instant::now();
                (watch.progress)(f64::from_bits(header.progress.load(Ordering::Relaxed)).clamp(0.0, 1.0));
            }
            beats = Some(beat);
            if stopping.is_none() && (watch.cancelled)() {
                header.cancel.store(1, Ordering::Relaxed);
                stopping = Some(Instant::now());
            }
            if stopping.is_some_and(|since| since.elapsed() > GRACE) {
                return Err(Silence::Cancelled);
            }
            if alive.elapsed() > limits.time {
                let seconds = limits.time.as_secs_f64();
                return Err(Silence::Died(format!(
                    "it did not answer and told no progress for {seconds} s; its process was ended"
                )));
            }
        }
    }

    /// Hands on what the process said.
    fn read(&self, reply: &[u8], sink: &mut dyn Sink) -> Result<Result<(), EvaluateError>, Garbled> {
        let mut take = Take::copied(reply, &self.shared);
        let mut fault = None;
        loop {
            let accepted = match u8::take(&mut take)? {
                TOLD => {
                    sink.tell(Message::take(&mut take)?);
                    continue;
                }
                SET => {
                    let output = u32::take(&mut take)?;
                    sink.set(output, Vec::take(&mut take)?).map_err(|why| format!("output {output}: {why}"))
                }
                FORWARDED => {
                    let (output, input) = (u32::take(&mut take)?, u32::take(&mut take)?);
                    sink.forward(output, input).map_err(|why| format!("output {output}: {why}"))
                }
                ENDED => break,
                other => return Err(Garbled::Mark(other)),
            };
            fault = fault.or(accepted.err());
        }
        let (mark, why) = (u8::take(&mut take)?, String::take(&mut take)?);
        Ok(match (mark, fault) {
            (CANCELLED, _) => Err(EvaluateError::Cancelled),
            (_, Some(fault)) => Err(EvaluateError::Fault(fault)),
            (WELL, None) => Ok(()),
            (FAILED, None) => Err(EvaluateError::Failed),
            _ => Err(EvaluateError::Fault(why)),
        })
    }

    /// How it ended, and the most memory that it had, bytes; `None` with `WNOHANG`: it lives.
    fn bury(&mut self, flags: i32) -> Option<(i32, u64)> {
        if self.id == 0 {
            return Some((0, 0));
        }
        let mut status = 0;
        // SAFETY: any bytes are good for a struct of numbers.
        let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
        // SAFETY: it is our child and not yet waited for; both places live through the call.
        let ended = unsafe { libc::wait4(self.id, &raw mut status, flags, &raw mut usage) };
        if ended != self.id {
            return None;
        }
        self.id = 0;
        Some((status, u64::try_from(usage.ru_maxrss).unwrap_or(0) << 10))
    }

    /// Why a process that hung up did.
    fn death(&mut self, limits: &Limits, stopping: bool) -> Silence {
        if stopping {
            return Silence::Cancelled;
        }
        // It hangs up just before it ends; one that only hung up is ended.
        let since = Instant::now();
        let ended = loop {
            if let Some(ended) = self.bury(libc::WNOHANG) {
                break Some(ended);
            }
            if since.elapsed() > GRACE {
                break None;
            }
            std::thread::sleep(Duration::from_millis(1));
        };
        let Some((status, most)) = ended else {
            return Silence::Died("it closed the connection to its host; its process was ended".into());
        };
        let mut why = if libc::WIFSIGNALED(status) {
            let signal = libc::WTERMSIG(status);
            let name = match signal {
                libc::SIGSEGV => ", a segmentation fault",
                libc::SIGABRT => ", which it raised itself (abort)",
                libc::SIGBUS => ", a bus error",
                libc::SIGFPE => ", an arithmetic error",
                libc::SIGILL => ", an illegal instruction",
                libc::SIGKILL => ", from outside",
                _ => "",
            };
            format!("its process was ended by signal {signal}{name}")
        } else {
            format!("it ended its process, with exit code {}", libc::WEXITSTATUS(status))
        };
        let own = most.saturating_sub(self.shared.len());
        if own >= limits.memory / 4 * 3 {
            why += &format!("; it had taken {} MiB of the {} that it may", own >> 20, limits.memory >> 20);
        }
        Silence::Died(why)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if self.id != 0 {
            // SAFETY: it is our child and not yet waited for, so the number is still its.
            unsafe { libc::kill(self.id, libc::SIGKILL) };
            self.bury(0);
        }
    }
}
