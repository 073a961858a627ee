//! Which vehicle is this, and what did an earlier run leave with it?
//!
//! The companion belongs to one vehicle from its first heartbeat on. A note of an earlier run may name that vehicle.

use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::{GLOBAL_POSITION_INT_DATA, HEARTBEAT_DATA};
use serde_json::json;

use fga_formats::geodesy::LocalFrame;

use super::lacking::Lacking;
use super::neighbors::{Neighbors, Senders};
use super::voice::Voice;
use crate::authority::{Beat, BeatOrder, Fault, Hearing, Owed, Severity, reaction};
use crate::mode::{Mode, ModeChange};
use crate::restart::Note;

/// The companion waits this long for the vehicle that an earlier run left in a manoeuvre, seconds: a vehicle sends its heartbeat once a
/// second.
const NOTED_S: f64 = 3.0;
/// Interval between reports of contradicting heartbeats, s.
const CONTRADICTION_AGAIN_S: f64 = 5.0;
/// Without a heartbeat for this long the vehicle is silent, seconds.
pub(super) const SILENT_S: f64 = 1.2;

/// The news of a plane's heartbeat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum News {
    /// None: another vehicle's.
    Nothing,
    /// A newer heartbeat of the vehicle came before it.
    Overtaken,
    /// From here on this is the vehicle.
    First,
    /// The vehicle goes on.
    Next {
        /// Its mode, and the one from before.
        mode: Mode,
        mode_was: Mode,
        /// Time without a heartbeat, seconds.
        silent_s: f64,
        /// Whether a contradiction is to be reported.
        contradicts: bool,
        /// Whether it was armed until now.
        disarmed: bool,
    },
}

/// What is to be done about a note of an earlier run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Noted {
    /// The vehicle may still carry out a request.
    Doubt(Note),
    /// The manoeuvre goes on.
    Resume(Note),
}

/// The vehicle that the companion belongs to.
#[derive(Debug)]
pub(super) struct Session {
    /// The configured vehicle; `None` takes the first plane.
    configured: Option<u8>,
    dry_run: bool,
    /// Whether the vehicle is recorded: it follows the commands of its own flight.
    recorded: bool,
    /// System id of the vehicle, and when it was first heard, seconds.
    heard: Option<(u8, f64)>,
    /// The vehicle's heartbeats, which decide whether the companion may command a mode.
    hearing: Hearing,
    /// The vehicle's time since boot in its last attitude, milliseconds.
    boot_ms: u32,
    /// The debt of an earlier run of the program.
    notes: Vec<Note>,
    /// The vehicle's clock when the mode was taken.
    noted_boot_ms: Option<u32>,
    /// Since when it waits for a vehicle with a note, seconds.
    noted_wait_s: Option<f64>,
    neighbors: Neighbors,
    senders: Senders,
    contradiction_due_s: f64,
}

impl Session {
    /// Nobody was heard yet; `system_id` is the configured vehicle, 0 for the first plane.
    pub(super) fn new(system_id: u8, dry_run: bool) -> Self {
        Self {
            configured: Some(system_id).filter(|id| *id != 0),
            dry_run,
            recorded: false,
            heard: None,
            hearing: Hearing::default(),
            boot_ms: 0,
            notes: Vec::new(),
            noted_boot_ms: None,
            noted_wait_s: None,
            neighbors: Neighbors::default(),
            senders: Senders::default(),
            contradiction_due_s: f64::NEG_INFINITY,
        }
    }

    /// Passes the debt of an earlier run, before any message.
    pub(super) fn set_notes(&mut self, notes: Vec<Note>) {
        self.notes = notes;
    }

    /// Whether the companion only reports.
    pub(super) const fn is_dry_run(&self) -> bool {
        self.dry_run
    }

    /// Whether the companion only reports, from now on.
    pub(super) const fn set_dry_run(&mut self, dry_run: bool) {
        self.dry_run = dry_run;
    }

    /// Marks the vehicle as recorded.
    pub(super) const fn set_recorded(&mut self) {
        self.recorded = true;
    }

    /// Whether the vehicle follows the commands of its own flight.
    pub(super) const fn is_recorded(&self) -> bool {
        self.recorded
    }

    /// System id of the vehicle, once heard.
    pub(super) fn system(&self) -> Option<u8> {
        self.heard.map(|(system_id, _)| system_id)
    }

    /// System id of the vehicle, where it may be commanded.
    pub(super) fn commanded_system(&self) -> Option<u8> {
        self.system().filter(|_| !self.dry_run)
    }

    /// The vehicle's mode, once heard.
    pub(super) fn mode(&self) -> Option<Mode> {
        self.hearing.mode()
    }

    pub(super) fn is_armed(&self) -> bool {
        self.hearing.is_armed()
    }

    /// Time since the last heartbeat, seconds; `None` before the first.
    pub(super) fn silent_s(&self, now_s: f64) -> Option<f64> {
        self.hearing.heard_s().map(|heard_s| now_s - heard_s)
    }

    /// The vehicle's time since boot, milliseconds.
    pub(super) const fn boot_ms(&self) -> u32 {
        self.boot_ms
    }

    /// What is heard instead of a vehicle, in words.
    pub(super) fn instead(&self) -> Option<String> {
        self.neighbors.instead()
    }

    /// The only system id that counts; `None` takes the first plane.
    fn wanted(&self) -> Option<u8> {
        // An earlier run of this program owes a mode to the vehicle that is heard.
        let noted = self.notes.last().filter(|_| self.heard.is_some());
        self.configured.or_else(|| noted.map(|note| note.system_id))
    }

    /// What about the vehicle forbids a take-over, or flying on.
    pub(super) fn lacking(&self, link_lost_s: f64, engaged: bool, now_s: f64) -> Option<Lacking> {
        let is_heard = self.silent_s(now_s).is_some_and(|s| s <= link_lost_s);
        let Some((_, since_s)) = self.heard.filter(|_| is_heard) else {
            return Some(Lacking::Link);
        };
        if self.hearing.is_contradicted(now_s) {
            Some(Lacking::Contradiction)
        } else if self.neighbors.is_ambiguous(now_s) {
            Some(Lacking::TwoVehicles)
        } else if self.wanted().is_none() && self.neighbors.may_come(since_s, now_s) {
            Some(Lacking::Listens)
        } else {
            (!engaged && self.senders.are_two(now_s)).then_some(Lacking::TwoSenders)
        }
    }

    /// From now on the vehicle is known.
    pub(super) const fn choose(&mut self) {
        self.neighbors.choose();
    }

    /// Whether the vehicle may be commanded another mode now; if so, the command counts as sent.
    pub(super) fn ask(&mut self, change: ModeChange, now_s: f64) -> bool {
        self.hearing.ask(change, now_s)
    }

    /// Takes a heartbeat of a plane.
    pub(super) fn hear(&mut self, system: u8, beat: Beat, voice: &mut Voice) -> News {
        let now_s = voice.now_s();
        let mode = beat.mode;
        let wanted = self.wanted();
        let Some((ours, _)) = self.heard else {
            if wanted.is_some_and(|wanted| wanted != system) {
                self.neighbors.hear_other(system);
                self.tell_left(system, mode, voice);
                return News::Nothing;
            }
            if self.waits_for_noted(system, mode, now_s) {
                return News::Nothing;
            }
            self.hearing.hear(beat, now_s);
            self.heard = Some((system, now_s));
            self.connected(system, mode, voice);
            return News::First;
        };
        if ours != system {
            if wanted.is_none() {
                self.neighbors.hear_plane(system, voice);
            }
            return News::Nothing;
        }
        let (mode_was, was_armed) = (self.mode().unwrap_or(mode), self.is_armed());
        let silent_s = self.silent_s(now_s).unwrap_or(0.0);
        let verdict = self.hearing.hear(beat, now_s);
        if verdict == BeatOrder::Overtaken {
            return News::Overtaken;
        }
        self.leave_notes(system, mode, voice);
        if mode != mode_was {
            voice.note("mode", json!({ "mode": mode.to_string() }));
        }
        let contradicts = verdict == BeatOrder::Contradicts && now_s >= self.contradiction_due_s;
        if contradicts {
            self.contradiction_due_s = now_s + CONTRADICTION_AGAIN_S;
        }
        News::Next {
            mode,
            mode_was,
            silent_s,
            contradicts,
            disarmed: was_armed && !self.is_armed(),
        }
    }

    fn connected(&mut self, system: u8, mode: Mode, voice: &mut Voice) {
        let others: Vec<u8> = self.notes.iter().map(|note| note.system_id).collect();
        self.notes.retain(|note| note.fits(system, mode));
        voice.speak_to(system);
        let words = if self.dry_run {
            "fga: connected, dry run"
        } else {
            "fga: connected"
        };
        voice.tell(Severity::Info, words);
        for other in others.into_iter().filter(|other| *other != system) {
            voice.warn(&format!("fga: note of vehicle {other} left aside"));
        }
        let content = json!({ "system": system, "mode": mode.to_string() });
        voice.note("vehicle", content);
    }

    /// Takes a heartbeat that is not a plane's.
    pub(super) fn hear_stranger(
        &mut self,
        header: MavHeader,
        data: &HEARTBEAT_DATA,
        voice: &mut Voice,
    ) {
        if self.heard.is_none() {
            let wanted = self.wanted();
            self.neighbors.hear_stranger(header, data, wanted, voice);
        }
    }

    /// The link carries MAVLink 1 frames of a system, which nobody here reads.
    pub(super) fn hear_version1(&mut self, system: u8, voice: &mut Voice) {
        if self.heard.is_none() {
            self.neighbors.hear_version1(system, voice);
        }
    }

    /// Takes a position of the vehicle's id, whoever sent it.
    pub(super) fn take_position(
        &mut self,
        data: &GLOBAL_POSITION_INT_DATA,
        frame: Option<&LocalFrame>,
        now_s: f64,
    ) {
        if let Some(frame) = frame {
            self.senders.take_position(data, frame, now_s);
        }
    }

    /// Takes the time since boot of an attitude, whoever sent it.
    pub(super) fn stamp(&mut self, boot_ms: u32, now_s: f64) {
        self.hearing.stamp(boot_ms, now_s);
        self.senders.stamp(boot_ms, now_s);
    }

    /// Takes the time since boot of an attitude that counts.
    pub(super) const fn set_boot_ms(&mut self, boot_ms: u32) {
        self.boot_ms = boot_ms;
    }

    /// Takes a round trip: when it began by our clock, and the vehicle's clock; seconds.
    pub(super) fn round_trip(&mut self, sent_s: f64, boot_s: f64, now_s: f64) {
        self.hearing.round_trip(sent_s, boot_s, now_s);
    }

    /// A manoeuvre begins: the vehicle's clock dates the note of it.
    pub(super) const fn date_note(&mut self) {
        self.noted_boot_ms = Some(self.boot_ms);
    }

    /// The note for a later run, if this one stops now: of the owed mode and the mission item that was asked for, or
    /// of a request for the mode `owned` that may still arrive.
    pub(super) fn restart_note(
        &self,
        owed: Option<Mode>,
        item: Option<u16>,
        owned: Mode,
        may_arrive: bool,
    ) -> Option<Note> {
        let system_id = self.commanded_system()?;
        if let Some(note) = self.notes.last() {
            // A note of another vehicle is another program's.
            return Some(*note);
        }
        let boot_ms = self.noted_boot_ms.unwrap_or(self.boot_ms);
        let note = Note::new(
            Owed {
                system_id,
                owned,
                previous: owed.or(self.mode())?,
            },
            boot_ms,
        );
        let given_up = owed.is_none();
        let item = item.filter(|_| !given_up);
        (may_arrive || !given_up).then_some(Note {
            given_up,
            item,
            ..note
        })
    }

    /// What an earlier run left counts once the vehicle's clock shows that. `target` is the mode of this run's manoeuvres.
    pub(super) fn take_note(
        &mut self,
        boot_ms: u32,
        target: Mode,
        voice: &mut Voice,
    ) -> Option<Noted> {
        let note = self.notes.pop()?;
        self.notes.clear();
        if !note.counts(boot_ms) {
            voice.warn("fga: an old note of a manoeuvre, mode left alone");
        } else if note.given_up {
            return Some(Noted::Doubt(note));
        } else if self.dry_run || Mode(note.owned_mode) != target {
            tell_left_in(note, voice);
        } else {
            self.neighbors.choose();
            self.noted_boot_ms = Some(note.boot_ms);
            let content = json!({ "previous": note.previous().name() });
            voice.note("resumes", content);
            return Some(Noted::Resume(note));
        }
        None
    }

    /// The vehicle reports a mode: the notes of other modes end. Not even a forged heartbeat ends a debt in silence.
    fn leave_notes(&mut self, system: u8, mode: Mode, voice: &mut Voice) {
        let noted = self.notes.len();
        self.notes.retain(|note| note.fits(system, mode));
        if self.notes.len() < noted {
            let row = reaction(Fault::ModeChanged);
            voice.tell(row.severity, row.text);
        }
    }

    /// Whether the vehicle that a note names may still be heard: that vehicle is ours.
    fn waits_for_noted(&mut self, system: u8, mode: Mode, now_s: f64) -> bool {
        if self.wanted().is_some()
            || self.notes.is_empty()
            || self.notes.iter().any(|note| note.fits(system, mode))
        {
            return false;
        }
        now_s - *self.noted_wait_s.get_or_insert(now_s) < NOTED_S
    }

    /// Reports that an earlier run left a vehicle that is not ours in a manoeuvre.
    fn tell_left(&mut self, system: u8, mode: Mode, voice: &mut Voice) {
        let is_left = |note: &Note| note.fits(system, mode) && note.owned_mode == mode.0;
        if let Some(index) = self.notes.iter().position(is_left) {
            tell_left_in(self.notes.remove(index), voice);
        }
    }
}

/// Reports that an earlier run left the vehicle in a manoeuvre that this one does not take up.
fn tell_left_in(note: Note, voice: &mut Voice) {
    let (system, mode) = (note.system_id, Mode(note.owned_mode));
    let (mode, previous) = (mode.name(), note.previous());
    let words = format!(
        "fga: vehicle {system} left in {mode}: set {}",
        previous.name()
    );
    voice.tell(Severity::Critical, &words);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn beat(sequence: u8, mode: Mode) -> Beat {
        Beat {
            sequence,
            mode,
            armed: true,
        }
    }

    fn note(system_id: u8) -> Note {
        let owed = Owed {
            system_id,
            owned: Mode::GUIDED,
            previous: Mode::AUTO,
        };
        Note::new(owed, 1_000)
    }

    #[test]
    fn the_first_plane_is_the_vehicle_unless_one_is_configured() {
        let (mut session, mut voice) = (Session::new(0, false), Voice::default());
        assert_eq!(session.lacking(3.0, false, 0.0), Some(Lacking::Link));
        let news = session.hear(3, beat(0, Mode::AUTO), voice.at(0.0));
        assert_eq!((news, session.system()), (News::First, Some(3)));
        assert_eq!(session.lacking(3.0, false, 0.1), Some(Lacking::Listens));
        assert_eq!(session.lacking(3.0, false, 2.0), None);
        // A second plane before the companion was ever ready.
        let news = session.hear(4, beat(0, Mode::AUTO), voice.at(2.0));
        assert_eq!((news, session.system()), (News::Nothing, Some(3)));
        assert_eq!(session.lacking(3.0, false, 2.0), Some(Lacking::TwoVehicles));
        let mut session = Session::new(4, true);
        let news = session.hear(3, beat(0, Mode::AUTO), voice.at(0.0));
        assert_eq!((news, session.system()), (News::Nothing, None));
        assert!(session.instead().is_some());
        session.hear(4, beat(0, Mode::AUTO), voice.at(0.0));
        assert_eq!(session.lacking(3.0, false, 0.0), None);
        assert_eq!(
            (session.system(), session.commanded_system()),
            (Some(4), None)
        );
    }

    #[test]
    fn a_note_is_taken_up_by_its_vehicle_in_its_mode_and_by_no_other() {
        let (mut session, mut voice) = (Session::new(0, false), Voice::default());
        session.set_notes(vec![note(3)]);
        // Another plane first: the one of the note may still come.
        let news = session.hear(4, beat(0, Mode::GUIDED), voice.at(0.0));
        assert_eq!((news, session.system()), (News::Nothing, None));
        let news = session.hear(3, beat(0, Mode::GUIDED), voice.at(0.5));
        assert_eq!(news, News::First);
        assert_eq!(
            session.restart_note(None, None, Mode::GUIDED, false),
            Some(note(3)),
            "it is owed until it is taken up"
        );
        let taken = session.take_note(2_000, Mode::GUIDED, voice.at(0.6));
        assert_eq!(taken, Some(Noted::Resume(note(3))));
        let later = session.restart_note(Some(Mode::AUTO), Some(7), Mode::GUIDED, false);
        let item = Some(7);
        assert_eq!(later, Some(Note { item, ..note(3) }));
        // The vehicle's clock says that it restarted since.
        session.set_notes(vec![note(3)]);
        assert_eq!(session.take_note(10, Mode::GUIDED, voice.at(0.7)), None);
        // A mode that somebody chose ends the debt.
        session.set_notes(vec![note(3)]);
        let told = voice.texts();
        session.hear(3, beat(1, Mode::RTL), voice.at(1.5));
        assert_eq!(voice.texts(), told + 1);
        assert_eq!(session.restart_note(None, None, Mode::GUIDED, false), None);
    }
}
