// fga inside ArduPlane: reports of AP_ADSB in, banks in AVOID_ADSB out. See docs/how-to-ardupilot-inside.md.
#define AP_MATH_ALLOW_DOUBLE_FUNCTIONS 1
#include "Plane.h"
#include "fga_task.h"

const AP_Param::GroupInfo FgaPlane::var_info[] = {
    AP_GROUPINFO_FLAGS("ENABLE", 1, FgaPlane, _enable, 0, AP_PARAM_FLAG_ENABLE),
    AP_GROUPINFO("RADIUS", 2, FgaPlane, _radius, 60),   // volume around others, m
    AP_GROUPINFO("BANK", 3, FgaPlane, _bank, 43),       // largest bank, deg; below ROLL_LIMIT_DEG
    AP_GROUPINFO("FACTOR", 4, FgaPlane, _factor, 0.7),  // flown turn rate over the ideal one
    AP_GROUPINFO("LAG", 5, FgaPlane, _lag, 0.5),        // lag of the bank, s
    AP_GROUPINFO("SIGMA", 6, FgaPlane, _sigma, 2),      // standard deviation of a reported position, m
    AP_GROUPEND
};

static constexpr uint16_t WAYPOINTS_MOST = 16;
static fga_task task;
static unsigned char storage[FGA_TASK_BYTES(WAYPOINTS_MOST)];
static fga_waypoint waypoints[WAYPOINTS_MOST];
static uint16_t items[WAYPOINTS_MOST], item;
static uint32_t changed_ms, alarms;
static Location origin;

static double seconds(uint32_t ms) { return (double)ms / 1000; }
static fga_enu enu(const Vector3f &ned) { return fga_enu{ned.y, ned.x, -ned.z}; }
int FgaPlane::mode() {
    // Take-off and landing are left alone.
    const bool is_leg = plane.control_mode == &plane.mode_auto && plane.mission.get_current_nav_id() == MAV_CMD_NAV_WAYPOINT;
    return is_leg ? FGA_TASK_MODE_MISSION : plane.control_mode == &plane.mode_avoidADSB ? FGA_TASK_MODE_AVOID : FGA_TASK_MODE_OTHER;
}

bool FgaPlane::begin() {
    fga_task_settings settings;
    fga_refusal why {sizeof(fga_refusal), 0, 0, "", ""};
    fga_status status = fga_task_settings_default(&settings, plane.aparm.airspeed_cruise.get(), radians(_bank.get()), &why);
    settings.vehicle.turn_rate_factor = _factor.get();
    settings.vehicle.bank_time_constant_s = _lag.get();
    settings.radius_m = _radius.get();
    // In need what ROLL_LIMIT_DEG and the wing allow.
    const float stall = sq(plane.aparm.airspeed_min.get() / plane.aparm.airspeed_cruise.get());
    const float steep_rad = MIN(radians(plane.aparm.roll_limit.get() - 2), acosf(MIN(stall, 1)));
    if (status == FGA_STATUS_OK && steep_rad > radians(_bank.get() + 2)) status = fga_task_settings_in_need(&settings, steep_rad, &why);
    if (status == FGA_STATUS_OK) status = fga_task_begin(&task, &settings, storage, sizeof(storage), WAYPOINTS_MOST, &why);
    origin = plane.ahrs.get_home();
    if (status == FGA_STATUS_OK) return true;
    gcs().send_text(MAV_SEVERITY_CRITICAL, "fga: %s is %.2f, expected %s", why.field, why.value, why.expected);
    return _enable.set(0), false;
}

// The way from the last waypoint on: present and later waypoints, up to the first other command. Where it changes in a manoeuvre, from
// the place where that began.
void FgaPlane::follow_mission() {
    AP_Mission &mission = plane.mission;
    if (item == mission.get_current_nav_index() && changed_ms == mission.last_change_time_ms()) return;
    item = mission.get_current_nav_index();
    changed_ms = mission.last_change_time_ms();
    fga_mission way {sizeof(fga_mission), 1, waypoints, -(double)INFINITY, (double)INFINITY};
    waypoints[0] = fga_waypoint{enu(origin.get_distance_NED(plane.prev_WP_loc)), FGA_PASSING_FLY_BY};
    AP_Mission::Mission_Command cmd;
    for (uint16_t k = item; way.waypoint_count < WAYPOINTS_MOST && mission.get_next_nav_cmd(k, cmd); k = cmd.index + 1) {
        Location place = cmd.content.location;
        if (cmd.id != MAV_CMD_NAV_WAYPOINT || !place.change_alt_frame(Location::AltFrame::ABSOLUTE)) break;
        items[way.waypoint_count] = cmd.index;
        waypoints[way.waypoint_count++] = fga_waypoint{enu(origin.get_distance_NED(place)), FGA_PASSING_FLY_BY};
    }
    (void)fga_task_set_mission(&task, &way, &task.why);
}

// All traffic: with AVD_ENABLE 0 nobody else takes samples from this queue. Speeds in cm/s, heading in cdeg.
void FgaPlane::hear_traffic(double now_s) {
    AP_ADSB::adsb_vehicle_t other;
    while (plane.adsb.next_sample(other)) {
        const double track_rad = radians(other.info.heading * 0.01), speed_mps = other.info.hor_velocity * 0.01;
        const fga_enu velocity {speed_mps * sin(track_rad), speed_mps * cos(track_rad), other.info.ver_velocity * 0.01};
        const fga_enu place = enu(origin.get_distance_NED(plane.adsb.get_location(other)));
        const fga_report report {sizeof(fga_report), other.info.ICAO_address, FGA_MOVEMENT_CREWED, 1, seconds(other.last_update_ms), place, velocity, _sigma.get(), 1, 0, 0, 0};
        fga_task_hear(&task, &report, now_s);
    }
}

// AUTO goes on with this item, also with MIS_RESTART 1.
void FgaPlane::give_back(uint16_t to) {
    if (to != plane.mission.get_current_nav_index()) (void)plane.mission.set_current_cmd(to);
    plane.mission.set_force_resume(true);
    (void)plane.set_mode(plane.mode_auto, ModeReason::AVOIDANCE_RECOVERY);
}

void FgaPlane::update() {
    if (!_enable || (!task.avoider && !(plane.ahrs.home_is_set() && begin()))) return;
    if (mode() != FGA_TASK_MODE_OTHER) follow_mission();
    Vector3f over_ground, wind;
    const bool is_fresh = plane.ahrs.get_velocity_NED(over_ground) && plane.ahrs.wind_estimate(wind);
    const bool pilot_hand = rc().has_valid_input() && fabsf(plane.channel_roll->norm_input_dz()) > 0.2f;
    const Vector3f air = over_ground - wind;
    const fga_ownship own {enu(origin.get_distance_NED(plane.current_loc)), atan2(air.x, air.y), -atan2(air.z, hypot(air.x, air.y)),
                           -plane.ahrs.get_roll_rad(), air.length()};
    const fga_task_input in {seconds(AP_HAL::millis()), (fga_task_mode)mode(), is_fresh, pilot_hand, own, enu(wind), 0, nullptr, 0, nullptr};
    hear_traffic(in.time_s);
    fga_task_output out;
    fga_task_step(&task, &in, &out);
    if (out.request == FGA_TASK_REQUEST_AVOID) (void)plane.set_mode(plane.mode_avoidADSB, ModeReason::AVOIDANCE);
    if (out.request == FGA_TASK_REQUEST_MISSION) give_back(out.next_waypoint < task.mission.waypoint_count ? items[out.next_waypoint] : item);
    if (out.commands) {  // AVOID_ADSB flies GUIDED's bank for at most 3 s, at the altitude of the change of mode
        plane.guided_state.forced_rpy_cd.x = -degrees(out.bank_left_rad) * 100;
        plane.guided_state.last_forced_rpy_ms.x = AP_HAL::millis();
    }
    if (out.alarms & ~alarms) gcs().send_text(MAV_SEVERITY_WARNING, "%s", fga_task_alarm_text(out.alarms & ~alarms));
    alarms = out.alarms;
    AP::logger().Write("FGA", "TimeUS,Phase,State,Why,Req,Alarm,Bank,Marg", "QBBBBBff", AP_HAL::micros64(), task.phase, task.decision.state,
                       task.decision.reason, out.request, out.alarms, degrees(out.bank_left_rad), task.decision.certified_margin_m);
}

void FgaPlane::watch() {
    if (task.avoider && fga_task_watch(&task, seconds(AP_HAL::millis()), (fga_task_mode)mode()) != FGA_TASK_REQUEST_NONE) give_back(item);
}
