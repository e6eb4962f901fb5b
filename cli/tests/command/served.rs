//! A joint that serves its tuning link at a socket or a serial device, in real time.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpListener;
use std::os::unix::net::UnixListener;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use serialport::{SerialPort as _, TTYPort};
use strainwave_service::simulation::joint::{Line, RestingJoint};
use strainwave_service::tuning::TuningLink;

/// Time of the joint between two looks at its line, and longest wait of a read in between.
const GLANCE: Duration = Duration::from_millis(1);

trait Stream: Read + Write + Send {}

impl<T: Read + Write + Send> Stream for T {}

/// The joint, until it is dropped.
pub struct Served {
    joint: Arc<Mutex<RestingJoint>>,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Served {
    /// At a socket of the file system.
    pub fn at_unix(path: &Path) -> Self {
        let listener = UnixListener::bind(path).unwrap();
        listener.set_nonblocking(true).unwrap();
        Self::start(move || {
            let (stream, _) = listener.accept().ok()?;
            stream.set_nonblocking(false).unwrap();
            stream.set_read_timeout(Some(GLANCE)).unwrap();
            Some(Box::new(stream) as Box<dyn Stream>)
        })
    }

    /// At a port of this machine, whose name is given too.
    pub fn at_tcp() -> (Self, String) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let name = format!("tcp:{}", listener.local_addr().unwrap());
        listener.set_nonblocking(true).unwrap();
        let served = Self::start(move || {
            let (stream, _) = listener.accept().ok()?;
            stream.set_nonblocking(false).unwrap();
            stream.set_read_timeout(Some(GLANCE)).unwrap();
            Some(Box::new(stream) as Box<dyn Stream>)
        });
        (served, name)
    }

    /// At a pseudo terminal, whose name is given too. Its slave's side must stay open, too.
    pub fn at_terminal() -> (Self, TTYPort, String) {
        let (mut master, slave) = TTYPort::pair().unwrap();
        master.set_timeout(GLANCE).unwrap();
        let name = slave.name().unwrap();
        let mut master = Some(master);
        let served = Self::start(move || master.take().map(|master| Box::new(master) as Box<dyn Stream>));
        (served, slave, name)
    }

    fn start(mut accept: impl FnMut() -> Option<Box<dyn Stream>> + Send + 'static) -> Self {
        let joint = Arc::new(Mutex::new(RestingJoint::default()));
        let ended = Arc::new(AtomicBool::new(false));
        let (served, end) = (joint.clone(), ended.clone());
        let thread = thread::spawn(move || {
            let (mut link, mut line, mut stream) = (TuningLink::default(), Line::default(), None);
            let (begun, mut run) = (Instant::now(), 0);
            while !end.load(Ordering::Relaxed) {
                stream = stream.or_else(&mut accept);
                let whole = stream.as_mut().is_none_or(|stream| receive(stream, &mut line));
                let due = (begun.elapsed().as_micros() / 100) as u32;
                locked(&served).run(&mut link, &mut line, due - run);
                run = due;
                let sent = stream.as_mut().is_none_or(|stream| stream.write_all(&line.back).is_ok());
                line.back.clear();
                if !(whole && sent) {
                    stream = None;
                }
                if stream.is_none() {
                    thread::sleep(GLANCE);
                }
            }
        });
        Self { joint, ended, thread: Some(thread) }
    }

    /// The joint, which stands still meanwhile.
    pub fn joint(&self) -> MutexGuard<'_, RestingJoint> {
        locked(&self.joint)
    }
}

fn locked(joint: &Mutex<RestingJoint>) -> MutexGuard<'_, RestingJoint> {
    joint.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes what has come; whether the other end is still there.
fn receive(stream: &mut Box<dyn Stream>, line: &mut Line) -> bool {
    let mut bytes = [0; 256];
    match stream.read(&mut bytes) {
        Ok(0) => false,
        Ok(count) => {
            line.there.extend(&bytes[..count]);
            true
        }
        Err(error) => matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut),
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
