//! One run as a picture that moves: an animated GIF of the top view, without text.
//!
//! Only the pixels that change are stored, in at most 256 colours that the whole animation shares.

use alloc::borrow::Cow;
use alloc::collections::BTreeMap;

use fga::Vec3;
use fga::avoider::State;
use gif::{DisposalMethod, EncodingError, Frame, Repeat};
use tiny_skia::{Color, FillRule, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

use crate::overview::Overview;
use crate::palette::{BLUE, GREEN, ORANGE, PAPER, PURPLE, SKY, VERMILION};

const WIDTH: u16 = 800;
const LEAST_HEIGHT: f64 = 200.0;
const MOST_HEIGHT: f64 = 600.0;
/// Space around what is drawn, pixels.
const MARGIN: f64 = 28.0;
const FRAMES: u32 = 220;
/// Time between frames, hundredths of a second.
const DELAY: u16 = 7;
/// Time of the last frame, hundredths of a second.
const LAST_DELAY: u16 = 250;
/// Half length of an aircraft, pixels.
const ARROW: f64 = 8.0;

/// Draws the run: the mission, the flown track as it grows in the colour of each state, and protected
/// volumes where they are at the time, empty while the aircraft is above or below.
///
/// # Errors
/// A run without a finite sample, or the encoder's own error.
pub fn gif(overview: &Overview) -> Result<Vec<u8>, String> {
    let (begin_s, end_s) = overview.times_s();
    let Some(view) = MovingView::of(overview).filter(|_| (end_s - begin_s).is_finite()) else {
        return Err("holds no finite sample to draw, expected one".to_owned());
    };
    let time_s = |frame: u32| begin_s + (end_s - begin_s) * f64::from(frame) / f64::from(FRAMES);
    let frames = (0..=FRAMES).map(|frame| view.frame(overview, time_s(frame)));
    let frames: Vec<Vec<u16>> = frames
        .collect::<Option<_>>()
        .ok_or("is too large to draw")?;
    encode(&frames, view.height).map_err(|error| format!("cannot be drawn: {error}"))
}

/// From metres to pixels.
struct MovingView {
    west_m: f64,
    north_m: f64,
    pixels_per_m: f64,
    height: u16,
}

impl MovingView {
    /// A view that shows the mission, the track and the obstacles at rest. Moving obstacles may enter it from outside.
    fn of(overview: &Overview) -> Option<Self> {
        let at_rest = overview.obstacles.iter().filter(|other| !other.moves());
        let at_rest = at_rest.filter_map(|other| Some(other.track.first()?.position_m));
        let shown = overview.mission_m.iter().copied();
        let mut places: Vec<Vec3> = shown.chain(at_rest).collect();
        places.extend(overview.finite_samples().map(|sample| sample.position_m));
        overview.finite_samples().next()?;
        places.retain(|place| place.is_finite());
        let (mut least, mut most) = (Vec3::MAX, Vec3::MIN);
        for place in places {
            (least, most) = (least.min(place), most.max(place));
        }
        let size = (most - least).max(Vec3::splat(1.0));
        let inner = f64::from(WIDTH) - 2.0 * MARGIN;
        let pixels_per_m = (inner / size.x).min((MOST_HEIGHT - 2.0 * MARGIN) / size.y);
        let height = (size.y * pixels_per_m + 2.0 * MARGIN).clamp(LEAST_HEIGHT, MOST_HEIGHT);
        let middle = (least + most) * 0.5;
        Some(Self {
            west_m: middle.x - 0.5 * f64::from(WIDTH) / pixels_per_m,
            north_m: middle.y + 0.5 * height / pixels_per_m,
            pixels_per_m,
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped"
            )]
            height: height as u16,
        })
    }

    #[expect(clippy::cast_possible_truncation, reason = "pixels of a drawing")]
    fn at(&self, place: Vec3) -> (f32, f32) {
        let x = (place.x - self.west_m) * self.pixels_per_m;
        let y = (self.north_m - place.y) * self.pixels_per_m;
        (x as f32, y as f32)
    }

    fn line(&self, places: impl Iterator<Item = Vec3>) -> Option<Path> {
        let mut path = PathBuilder::new();
        for place in places.filter(|place| place.is_finite()) {
            let (x, y) = self.at(place);
            if path.is_empty() {
                path.move_to(x, y);
            } else {
                path.line_to(x, y);
            }
        }
        path.finish()
    }

    /// An arrow at the end of two places, towards the second.
    fn arrow(&self, from: Vec3, to: Vec3) -> Option<Path> {
        let ahead = Vec3::new(to.x - from.x, to.y - from.y, 0.0).normalize_or(Vec3::X);
        let left = Vec3::new(-ahead.y, ahead.x, 0.0);
        let corner = |forward: f64, aside: f64| {
            to + (ahead * forward + left * aside) * (ARROW / self.pixels_per_m)
        };
        let corners = [
            corner(1.3, 0.0),
            corner(-1.0, 0.8),
            corner(-0.5, 0.0),
            corner(-1.0, -0.8),
        ];
        self.line(corners.into_iter())
    }

    /// The picture at a time, a colour of 5, 6 and 5 bits for each pixel.
    fn frame(&self, overview: &Overview, time_s: f64) -> Option<Vec<u16>> {
        let mut picture = Pixmap::new(u32::from(WIDTH), u32::from(self.height))?;
        picture.fill(color(PAPER, 255));
        for obstacle in &overview.obstacles {
            let Some(place) = obstacle
                .position_at_m(time_s)
                .filter(|place| place.is_finite())
            else {
                continue;
            };
            let (x, y) = self.at(place);
            #[expect(clippy::cast_possible_truncation, reason = "pixels of a drawing")]
            let radius = (obstacle.volume.radius_m() * self.pixels_per_m) as f32;
            if let Some(circle) = PathBuilder::from_circle(x, y, radius.max(2.0)) {
                // Empty where the aircraft is above or below.
                let apart_m = |own: Vec3| (own.z - place.z).abs();
                let own = overview.position_at_m(time_s);
                if own
                    .map(apart_m)
                    .is_none_or(|m| m < obstacle.volume.half_height_m())
                {
                    fill(&mut picture, &circle, PURPLE, 70);
                }
                stroke(&mut picture, &circle, PURPLE, 1.5, None);
            }
            let before = obstacle
                .position_at_m(time_s - 1.0)
                .filter(|_| obstacle.moves());
            if let Some(arrow) = before.and_then(|before| self.arrow(before, place)) {
                fill(&mut picture, &arrow, PURPLE, 255);
            }
        }
        if let Some(mission) = self.line(overview.mission_m.iter().copied()) {
            let dash = StrokeDash::new(vec![7.0, 5.0], 0.0);
            stroke(&mut picture, &mission, SKY, 1.5, dash);
        }
        let flown: Vec<_> = overview
            .finite_samples()
            .filter(|s| s.time_s <= time_s)
            .collect();
        for piece in flown.chunk_by(|a, b| a.state == b.state) {
            // Each piece reaches to the first sample of the next one.
            let last = piece.last()?.time_s;
            let next = flown.iter().find(|sample| sample.time_s > last);
            let places = piece.iter().chain(next).map(|sample| sample.position_m);
            if let Some(track) = self.line(places) {
                stroke(&mut picture, &track, state_color(piece[0].state), 2.6, None);
            }
        }
        if let (Some(to), Some(state)) = (overview.position_at_m(time_s), flown.last()) {
            let from = overview.position_at_m(time_s - 1.0)?;
            let ahead = if from == to {
                overview.position_at_m(time_s + 1.0)? - to
            } else {
                to - from
            };
            if let Some(arrow) = self.arrow(to - ahead, to) {
                fill(&mut picture, &arrow, state_color(state.state), 255);
            }
        }
        let pixels = picture.pixels().iter();
        Some(
            pixels
                .map(|pixel| {
                    let part = |value: u8, bits: u32| u16::from(value >> (8 - bits));
                    part(pixel.red(), 5) << 11 | part(pixel.green(), 6) << 5 | part(pixel.blue(), 5)
                })
                .collect(),
        )
    }
}

const fn state_color(state: State) -> &'static str {
    match state {
        State::Cruise => BLUE,
        State::Threatened => ORANGE,
        State::Avoiding => VERMILION,
        State::Recovering => GREEN,
    }
}

/// A colour of the palette with an opacity.
fn color(name: &str, opacity: u8) -> Color {
    let part = |at: usize| {
        let digits = name.get(at..at + 2).unwrap_or_default();
        u8::from_str_radix(digits, 16).unwrap_or_default()
    };
    Color::from_rgba8(part(1), part(3), part(5), opacity)
}

fn paint(name: &str, opacity: u8) -> Paint<'static> {
    let mut paint = Paint {
        anti_alias: true,
        ..Paint::default()
    };
    paint.set_color(color(name, opacity));
    paint
}

fn fill(picture: &mut Pixmap, path: &Path, name: &str, opacity: u8) {
    let paint = paint(name, opacity);
    picture.fill_path(path, &paint, FillRule::Winding, Transform::identity(), None);
}

fn stroke(picture: &mut Pixmap, path: &Path, name: &str, width: f32, dash: Option<StrokeDash>) {
    let stroke = Stroke {
        width,
        dash,
        ..Stroke::default()
    };
    picture.stroke_path(
        path,
        &paint(name, 255),
        &stroke,
        Transform::identity(),
        None,
    );
}

/// The colours that the most pixels have, at most 256, and the nearest of them for every colour.
fn palette(frames: &[Vec<u16>]) -> (Vec<u8>, BTreeMap<u16, u8>) {
    let mut counts = vec![0_u64; 1 << 16];
    for color in frames.iter().flatten() {
        counts[usize::from(*color)] += 1;
    }
    let mut used: Vec<u16> = (0..=u16::MAX)
        .filter(|color| counts[usize::from(*color)] > 0)
        .collect();
    used.sort_by_key(|color| core::cmp::Reverse(counts[usize::from(*color)]));
    let parts = |color: u16| {
        let part = |shift: u32, bits: u32| {
            let most = (1_i32 << bits) - 1;
            (i32::from(color) >> shift & most) * 255 / most
        };
        [part(11, 5), part(5, 6), part(0, 5)]
    };
    let kept = &used[..used.len().min(256)];
    let distance = |a: u16, b: u16| -> i32 {
        let pairs = parts(a).into_iter().zip(parts(b));
        pairs.map(|(a, b)| (a - b) * (a - b)).sum()
    };
    let nearest = |color: u16| {
        (0..=u8::MAX)
            .zip(kept)
            .min_by_key(|(_, near)| distance(color, **near))
    };
    let nearest = used
        .iter()
        .map(|color| (*color, nearest(*color).map_or(0, |(index, _)| index)));
    let bytes = kept.iter().flat_map(|color| parts(*color));
    let bytes = bytes
        .map(|part| u8::try_from(part).unwrap_or(u8::MAX))
        .collect();
    (bytes, nearest.collect())
}

fn encode(frames: &[Vec<u16>], height: u16) -> Result<Vec<u8>, EncodingError> {
    let (colors, nearest) = palette(frames);
    let width = usize::from(WIDTH);
    let mut file = Vec::new();
    let mut encoder = gif::Encoder::new(&mut file, WIDTH, height, &colors)?;
    encoder.set_repeat(Repeat::Infinite)?;
    let mut before: Option<&Vec<u16>> = None;
    for (index, frame) in frames.iter().enumerate() {
        // The rectangle of what changed; one pixel where nothing did.
        let (mut left, mut top, mut right, mut bottom) = (width, usize::from(height), 0, 0);
        for (at, pixel) in frame.iter().enumerate() {
            if before.is_none_or(|before| before.get(at) != Some(pixel)) {
                let (x, y) = (at % width, at / width);
                (left, right) = (left.min(x), right.max(x));
                (top, bottom) = (top.min(y), bottom.max(y));
            }
        }
        (left, top) = (left.min(right), top.min(bottom));
        let rows = frame.chunks(width).take(bottom + 1).skip(top);
        let part = rows.flat_map(|row| row.iter().take(right + 1).skip(left));
        let part: Vec<u8> = part
            .map(|color| nearest.get(color).copied().unwrap_or(0))
            .collect();
        let short = |pixels: usize| u16::try_from(pixels).unwrap_or(u16::MAX);
        encoder.write_frame(&Frame {
            delay: if index + 1 == frames.len() {
                LAST_DELAY
            } else {
                DELAY
            },
            dispose: DisposalMethod::Keep,
            left: short(left),
            top: short(top),
            width: short(right + 1 - left),
            height: short(bottom + 1 - top),
            buffer: Cow::Owned(part),
            ..Frame::default()
        })?;
        before = Some(frame);
    }
    drop(encoder);
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overview::{OverviewObstacle, OverviewPoint, PathSample};
    use fga::situation::ProtectedVolume;

    fn flown(seconds: u32) -> Overview {
        let sample = |second: u32| PathSample {
            time_s: f64::from(second),
            position_m: Vec3::new(15.0 * f64::from(second), 0.0, 50.0),
            state: if second < 10 {
                State::Cruise
            } else {
                State::Avoiding
            },
        };
        let point = |time_s: f64| OverviewPoint {
            time_s,
            position_m: Vec3::new(400.0 - 15.0 * time_s, 60.0, 50.0),
        };
        Overview {
            mission_m: vec![Vec3::ZERO, Vec3::new(400.0, 0.0, 50.0)],
            samples: (0..seconds).map(sample).collect(),
            obstacles: vec![OverviewObstacle {
                id: 1,
                name: "N1".into(),
                volume: ProtectedVolume::Sphere { radius_m: 30.0 },
                track: vec![point(0.0), point(30.0)],
                closest: None,
            }],
            ..Overview::default()
        }
    }

    /// Read again, the last frame shows the whole track and the first one none of it.
    #[test]
    fn the_track_grows_from_frame_to_frame() {
        let bytes = gif(&flown(27)).expect("a picture");
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::Indexed);
        let mut decoder = options.read_info(bytes.as_slice()).expect("a GIF");
        let (width, height) = (usize::from(decoder.width()), usize::from(decoder.height()));
        let colors = decoder.global_palette().expect("a palette").to_vec();
        let orange = |index: u8| {
            let at = 3 * usize::from(index);
            colors[at] > 200 && colors[at + 1] < 110 && colors[at + 2] < 30
        };
        let mut picture = vec![0_u8; width * height];
        let mut counts = Vec::new();
        while let Some(frame) = decoder.read_next_frame().expect("a frame") {
            for (row, line) in frame.buffer.chunks(usize::from(frame.width)).enumerate() {
                let at = (usize::from(frame.top) + row) * width + usize::from(frame.left);
                picture[at..at + line.len()].copy_from_slice(line);
            }
            counts.push(picture.iter().filter(|index| orange(**index)).count());
        }
        assert_eq!(counts.len(), FRAMES as usize + 1);
        assert_eq!(counts[0], 0);
        let pixels_of_track = 16 * 15 * (width - 56) / 400;
        let last = counts[FRAMES as usize];
        assert!(
            last > pixels_of_track && last < 5 * pixels_of_track,
            "{last}"
        );
        assert!(counts[150] > counts[120], "{counts:?}");
    }

    #[test]
    fn a_run_without_a_finite_sample_is_refused() {
        assert!(gif(&Overview::default()).is_err());
        let mut lost = flown(3);
        for sample in &mut lost.samples {
            sample.position_m.x = f64::NAN;
        }
        assert!(gif(&lost).is_err());
        assert!(gif(&flown(1)).is_ok());
    }
}
