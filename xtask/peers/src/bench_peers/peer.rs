//! A peer's process: started once, asked line by line, so that its starting is in no time.
//!
//! A peer gets its files as arguments, reads them, and prints one line of JSON with its `version`. Then
//! each line on its standard input is a request, words with blanks between, and each line of JSON on its
//! standard output the answer. It ends at the end of its input.

use std::cell::RefCell;
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::rc::Rc;

use anyhow::{Context, Result, bail};
use serde_json::Value;

use super::contender::{Answer, Contender, Label};

/// How a peer is started.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Program {
    pub(crate) path: PathBuf,
    pub(crate) arguments: Vec<PathBuf>,
    /// How it was built, for the report.
    pub(crate) built: String,
}

/// A peer that waits for requests.
#[derive(Debug)]
pub(crate) struct Peer {
    child: Child,
    requests: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
    pub(crate) version: String,
}

impl Peer {
    /// Starts a peer and waits until it has read its files.
    pub(crate) fn start(program: &Program, files: &[PathBuf]) -> Result<Self> {
        let mut child = Command::new(&program.path)
            .args(&program.arguments)
            .args(files)
            // no library may take threads that were not asked for
            .env("OPENBLAS_NUM_THREADS", "1")
            .env("OMP_NUM_THREADS", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| format!("{} cannot be started", program.path.display()))?;
        let requests = child.stdin.take();
        let answers = child.stdout.take().context("a peer without output")?;
        let mut peer = Self {
            child,
            requests,
            answers: BufReader::new(answers),
            version: String::new(),
        };
        let first: Value = serde_json::from_str(&peer.line()?)?;
        peer.version = first["version"].as_str().unwrap_or("unknown").to_owned();
        Ok(peer)
    }

    pub(crate) fn ask(&mut self, request: &str) -> Result<String> {
        let requests = self.requests.as_mut().context("a peer without input")?;
        writeln!(requests, "{request}")
            .and_then(|()| requests.flush())
            .with_context(|| format!("a peer ended before `{request}`"))?;
        self.line()
            .with_context(|| format!("the request was `{request}`"))
    }

    fn line(&mut self) -> Result<String> {
        let mut line = String::new();
        if self.answers.read_line(&mut line)? == 0 {
            bail!("a peer ended without an answer; its message is above");
        }
        Ok(line)
    }

    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // The end of its input ends it.
        drop(self.requests.take());
        let _ = self.child.wait();
    }
}

/// One way of a peer; several share its process.
#[derive(Debug, Clone)]
pub(crate) struct PeerContender {
    pub(crate) label: Label,
    /// The request but for the repeats, its last word.
    pub(crate) request: String,
    /// Calls that one time of an answer covers; the answer is divided by it.
    pub(crate) calls: usize,
    pub(crate) peer: Rc<RefCell<Peer>>,
}

impl Contender for PeerContender {
    fn label(&self) -> &Label {
        &self.label
    }

    fn process(&self) -> Option<u32> {
        Some(self.peer.borrow().id())
    }

    fn run(&mut self, repeats: usize) -> Result<Answer> {
        let request = format!("{} {}", self.request, repeats.max(1));
        let asked = self.peer.borrow_mut().ask(&request);
        let line = asked.with_context(|| format!("{}: {}", self.label.family, self.label.name))?;
        let mut answer = Answer::from_json(&line)?;
        for time in &mut answer.solve_s {
            *time /= self.calls as f64;
        }
        Ok(answer)
    }
}
