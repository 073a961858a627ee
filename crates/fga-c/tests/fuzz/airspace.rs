//! Drawn zones and ground, right ones and wrong ones.

use core::ptr;

use fga_c::*;

use crate::Fuzz;

/// What a drawn situation lends.
#[derive(Default)]
pub(crate) struct Airspace {
    corners: Vec<Vec<fga_place>>,
    zones: Vec<fga_zone>,
    heights_m: Vec<f32>,
    peaks_m: Vec<f32>,
    ground: Option<Box<fga_ground>>,
}

impl Fuzz {
    fn place(&mut self, east_m: f64, north_m: f64, most_m: f64) -> fga_place {
        fga_place {
            east_m: self.number(east_m - most_m, east_m + most_m),
            north_m: self.number(north_m - most_m, north_m + most_m),
        }
    }

    fn zone(&mut self) -> fga_zone {
        let own = self.own.position_m;
        let (east_m, north_m) = (
            own.east + self.real(-300.0, 900.0),
            own.north + self.real(-400.0, 400.0),
        );
        let count = self.below(12);
        let count = if count < 3 { 0 } else { count };
        let corners = (0..count).map(|_| self.place(east_m, north_m, 150.0));
        let mut corners: Vec<fga_place> = corners.collect();
        let list = match count {
            0 => ptr::null_mut(),
            _ => self.pointer(corners.as_mut_ptr()),
        };
        self.around.corners.push(corners);
        let has_floor = self.one_in(3);
        let mut zone = fga_zone {
            kind: self.enumerated(0, 1),
            corner_count: count,
            corners: list,
            center: fga_place { east_m, north_m },
            radius_m: self.real(1.0, 200.0),
            floor_m: if has_floor {
                self.real(-100.0, 100.0)
            } else {
                f64::NEG_INFINITY
            },
            ceiling_m: f64::INFINITY,
        };
        match self.below(300) {
            0 => {
                self.wrong();
                zone.ceiling_m = f64::NEG_INFINITY;
            }
            1 => {
                self.wrong();
                zone.corner_count =
                    [1, 2, FGA_ZONE_CORNERS_MOST + 1, u32::MAX][self.below(4) as usize];
            }
            2 if count == 0 => {
                self.wrong();
                zone.radius_m = [0.0, -1.0, f64::NAN][self.below(3) as usize];
            }
            _ => {}
        }
        zone
    }

    /// Lends zones to a situation, and ground.
    pub(crate) fn lend(&mut self, situation: &mut fga_situation) {
        self.around = Airspace::default();
        let count = if self.one_in(2) { 0 } else { self.below(4) };
        for _ in 0..count {
            let zone = self.zone();
            self.around.zones.push(zone);
        }
        situation.zone_count = count;
        if count > 0 {
            let zones = self.around.zones.as_mut_ptr();
            situation.zones = self.pointer(zones);
        }
        if self.one_in(300) {
            self.wrong();
            situation.zone_count = u32::MAX - self.below(3);
        }
        if self.one_in(2) {
            situation.ground = self.ground();
        }
    }

    fn ground(&mut self) -> *const fga_ground {
        let (columns, rows) = (2 + self.below(20), 2 + self.below(20));
        let heights = (0..columns * rows).map(|_| match self.below(50) {
            0 => f32::NAN,
            1 => f32::INFINITY,
            _ => f32::from(u16::try_from(self.below(450)).unwrap()) - 300.0,
        });
        let heights_m: Vec<f32> = heights.collect();
        let count = fga_ground_peak_count(columns, rows) as usize;
        let mut peaks_m = vec![0.0; count.max(1)];
        // SAFETY: right pointers.
        let filled = unsafe {
            fga_ground_fill_peaks(columns, rows, heights_m.as_ptr(), peaks_m.as_mut_ptr())
        };
        assert_eq!(filled, fga_status::Ok);
        self.around.heights_m = heights_m;
        self.around.peaks_m = peaks_m;
        let own = self.own.position_m;
        let (heights_m, peaks_m) = (
            self.around.heights_m.as_mut_ptr(),
            self.around.peaks_m.as_mut_ptr(),
        );
        let mut ground = fga_ground {
            size: self.size::<fga_ground>(),
            columns,
            rows,
            corner: self.place(own.east - 500.0, own.north - 500.0, 200.0),
            spacing: fga_place {
                east_m: self.real(20.0, 100.0),
                north_m: self.real(20.0, 100.0),
            },
            heights_m: self.pointer(heights_m),
            peaks_m: if count == 0 {
                peaks_m
            } else {
                self.pointer(peaks_m)
            },
            error_m: self.number(0.0, 16.0),
            clearance_m: self.number(0.0, 60.0),
        };
        match self.below(200) {
            0 => {
                self.wrong();
                ground.rows = [0, 1, FGA_GROUND_POSTS_MOST + 1, u32::MAX][self.below(4) as usize];
            }
            1 => {
                self.wrong();
                ground.spacing.north_m = [0.0, -5.0, f64::NAN][self.below(3) as usize];
            }
            _ => {}
        }
        let ground = self.around.ground.insert(Box::new(ground));
        let ground = &raw mut **ground;
        if self.one_in(400) {
            self.wrong();
            return ground.wrapping_byte_add(1 + self.below(3) as usize);
        }
        ground
    }
}
