//! Parameters: the few that the emulation or a companion reads, with ArduPlane's names.

/// Parameters, in the order of their names.
#[derive(Debug, Clone)]
pub struct Parameters(Vec<(&'static str, f64)>);

impl Default for Parameters {
    fn default() -> Self {
        Self(vec![
            ("ADSB_TYPE", 1.0),
            ("AIRSPEED_CRUISE", 25.0),
            ("AIRSPEED_MAX", 30.0),
            ("AIRSPEED_MIN", 12.0),
            ("AVD_ENABLE", 0.0),
            ("AVD_F_ACTION", 1.0),
            ("AVD_W_ACTION", 1.0),
            ("FENCE_ACTION", 1.0),
            ("FENCE_ALT_MAX", 0.0),
            ("FENCE_ALT_MIN", 0.0),
            ("FENCE_ENABLE", 0.0),
            ("FENCE_OPTIONS", 1.0),
            ("FENCE_RADIUS", 0.0),
            ("FENCE_TYPE", 4.0),
            ("GUIDED_TIMEOUT", 3.0),
            ("MAV_GCS_SYSID", 255.0),
            ("MIS_RESTART", 0.0),
            ("NAVL1_PERIOD", 17.0),
            ("PTCH_LIM_MAX_DEG", 20.0),
            ("PTCH_LIM_MIN_DEG", -25.0),
            ("RALLY_INCL_HOME", 0.0),
            ("RALLY_LIMIT_KM", 5.0),
            ("RC_OVERRIDE_TIME", 3.0),
            ("ROLL_LIMIT_DEG", 45.0),
            ("TECS_CLMB_MAX", 5.0),
            ("TECS_SINK_MAX", 5.0),
            ("TERRAIN_ENABLE", 1.0),
            ("WP_LOITER_RAD", 60.0),
            ("WP_RADIUS", 30.0),
        ])
    }
}

impl Parameters {
    fn place(&self, name: &str) -> Option<usize> {
        self.0.binary_search_by(|row| row.0.cmp(name)).ok()
    }

    /// The value of an existing parameter.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.place(name).map(|place| self.0[place].1)
    }

    /// The value, or 0 for an unknown one.
    pub fn value(&self, name: &str) -> f64 {
        self.get(name).unwrap_or(0.0)
    }

    /// Sets an existing one; `false` for an unknown one.
    pub fn set(&mut self, name: &str, value: f64) -> bool {
        let place = self.place(name);
        place.map(|place| self.0[place].1 = value).is_some()
    }

    /// Removes a parameter: an older or newer firmware lacks it.
    pub fn remove(&mut self, name: &str) {
        self.0.retain(|row| row.0 != name);
    }

    /// All, in order.
    pub fn rows(&self) -> &[(&'static str, f64)] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_in_order() {
        assert!(Parameters::default().rows().is_sorted_by_key(|row| row.0));
    }
}
