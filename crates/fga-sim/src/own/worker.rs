//! A thread that answers questions, each within a time limit.

use core::time::Duration;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};

/// Why there is no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Silence {
    /// The time limit is over.
    TimedOut,
    /// The thread has ended.
    Ended,
}

/// A thread that answers questions in their order. It ends once the worker is dropped and the last question is answered: nobody
/// waits for a thread that hangs.
#[derive(Debug)]
pub struct Worker<Q, A> {
    questions: Sender<Q>,
    answers: Receiver<A>,
}

impl<Q: Send + 'static, A: Send + 'static> Worker<Q, A> {
    /// Starts a thread.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn start(mut answer: impl FnMut(Q) -> A + Send + 'static) -> std::io::Result<Self> {
        let (questions, asked) = channel();
        let (answering, answers) = channel();
        std::thread::Builder::new()
            .name("policy".into())
            .spawn(move || {
                for question in asked {
                    if answering.send(answer(question)).is_err() {
                        break;
                    }
                }
            })?;
        Ok(Self { questions, answers })
    }

    /// The answer to a question. After a silence the worker is of no use.
    ///
    /// # Errors
    /// No answer within the limit, or no thread.
    pub fn ask(&self, question: Q, limit: Duration) -> Result<A, Silence> {
        self.questions.send(question).map_err(|_| Silence::Ended)?;
        self.answers
            .recv_timeout(limit)
            .map_err(|error| match error {
                RecvTimeoutError::Timeout => Silence::TimedOut,
                RecvTimeoutError::Disconnected => Silence::Ended,
            })
    }
}
