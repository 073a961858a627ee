// fga as a module of PX4: transponder_report in, fixed_wing_lateral_setpoint out. See docs/how-to-px4-inside.md.
#include <drivers/drv_hrt.h>
#include <fga_task.h>
#include <lib/geo/geo.h>
#include <matrix/math.hpp>
#include <px4_platform_common/log.h>
#include <px4_platform_common/tasks.h>
#include <px4_platform_common/time.h>
#include <string.h>
#include <uORB/Publication.hpp>
#include <uORB/Subscription.hpp>
#include <uORB/topics/arming_check_reply.h>
#include <uORB/topics/arming_check_request.h>
#include <uORB/topics/fixed_wing_lateral_setpoint.h>
#include <uORB/topics/fixed_wing_longitudinal_setpoint.h>
#include <uORB/topics/manual_control_setpoint.h>
#include <uORB/topics/position_setpoint_triplet.h>
#include <uORB/topics/register_ext_component_reply.h>
#include <uORB/topics/register_ext_component_request.h>
#include <uORB/topics/transponder_report.h>
#include <uORB/topics/vehicle_attitude.h>
#include <uORB/topics/vehicle_command.h>
#include <uORB/topics/vehicle_control_mode.h>
#include <uORB/topics/vehicle_local_position.h>
#include <uORB/topics/vehicle_status.h>
#include <uORB/topics/wind.h>

class Fga {
public:
	bool begin(double airspeed_mps, double bank_rad, double turn_rate_factor);
	void step();  // at 10 Hz

private:
	bool register_mode();
	void follow_mission();
	void set_nav_state(uint8_t nav_state);
	fga_enu enu(double latitude_deg, double longitude_deg, double altitude_m);

	fga_task _task {};
	unsigned char _storage[FGA_TASK_BYTES(3)];
	fga_waypoint _way[3];
	uint32_t _alarms {0};
	int _mode_id {-1}, _registration_id {-1};
	bool _asked {false};
	MapProjection _map;
	double _map_altitude_m {0};
	vehicle_status_s _status {};
	vehicle_local_position_s _local {};
	vehicle_attitude_s _attitude {};
	wind_s _wind {};
	manual_control_setpoint_s _sticks {};

	uORB::Subscription _status_sub{ORB_ID(vehicle_status)}, _local_sub{ORB_ID(vehicle_local_position)}, _attitude_sub{ORB_ID(vehicle_attitude)},
		_wind_sub{ORB_ID(wind)}, _sticks_sub{ORB_ID(manual_control_setpoint)}, _triplet_sub{ORB_ID(position_setpoint_triplet)},
		_traffic_sub{ORB_ID(transponder_report)}, _registered_sub{ORB_ID(register_ext_component_reply)}, _check_sub{ORB_ID(arming_check_request)};
	uORB::Publication<register_ext_component_request_s> _register_pub{ORB_ID(register_ext_component_request)};
	uORB::Publication<arming_check_reply_s> _check_pub{ORB_ID(arming_check_reply)};
	uORB::Publication<vehicle_control_mode_s> _configure_pub{ORB_ID(config_control_setpoints)};
	uORB::Publication<vehicle_command_s> _command_pub{ORB_ID(vehicle_command)};
	uORB::Publication<fixed_wing_lateral_setpoint_s> _lateral_pub{ORB_ID(fixed_wing_lateral_setpoint)};
	uORB::Publication<fixed_wing_longitudinal_setpoint_s> _longitudinal_pub{ORB_ID(fixed_wing_longitudinal_setpoint)};
};

bool Fga::begin(double airspeed_mps, double bank_rad, double turn_rate_factor) {
	fga_task_settings settings;
	fga_refusal why {sizeof(fga_refusal), 0, 0, "", ""};
	fga_status status = fga_task_settings_default(&settings, airspeed_mps, bank_rad, &why);
	settings.vehicle.turn_rate_factor = turn_rate_factor;
	if (status == FGA_STATUS_OK) status = fga_task_begin(&_task, &settings, _storage, sizeof(_storage), 3, &why);
	if (status != FGA_STATUS_OK) PX4_ERR("%s is %.2f, expected %s", why.field, why.value, why.expected);
	return status == FGA_STATUS_OK;
}

// A mode of its own, and the answer to each arming check, without which PX4 takes the mode for dead.
bool Fga::register_mode() {
	if (!_asked) {
		register_ext_component_request_s request {};
		request.timestamp = request.request_id = hrt_absolute_time();
		strncpy(request.name, "fga", sizeof(request.name) - 1);
		request.px4_ros2_api_version = register_ext_component_request_s::LATEST_PX4_ROS2_API_VERSION;
		request.register_arming_check = request.register_mode = request.not_user_selectable = true;
		_register_pub.publish(request);
		_asked = true;
	}
	register_ext_component_reply_s reply;
	if (_registered_sub.update(&reply) && reply.success && !strcmp(reply.name, "fga")) {
		_mode_id = reply.mode_id;
		_registration_id = reply.arming_check_id;
		vehicle_control_mode_s flags {};
		flags.timestamp = hrt_absolute_time();
		flags.source_id = _mode_id;
		flags.flag_control_position_enabled = flags.flag_control_velocity_enabled = flags.flag_control_altitude_enabled = true;
		flags.flag_control_climb_rate_enabled = flags.flag_control_acceleration_enabled = true;
		flags.flag_control_attitude_enabled = flags.flag_control_rates_enabled = flags.flag_control_allocation_enabled = true;
		_configure_pub.publish(flags);
	}
	arming_check_request_s check;
	if (_mode_id >= 0 && _check_sub.update(&check)) {
		arming_check_reply_s answer {};
		answer.timestamp = hrt_absolute_time();
		answer.request_id = check.request_id;
		answer.registration_id = _registration_id;
		answer.can_arm_and_run = true;
		answer.mode_req_local_position = answer.mode_req_local_alt = answer.mode_req_attitude = true;
		_check_pub.publish(answer);
	}
	return _mode_id >= 0;
}

fga_enu Fga::enu(double latitude_deg, double longitude_deg, double altitude_m) {
	float north_m, east_m;
	_map.project(latitude_deg, longitude_deg, north_m, east_m);
	return fga_enu{east_m, north_m, altitude_m - _map_altitude_m};
}

// The present leg of the mission and the next one.
void Fga::follow_mission() {
	position_setpoint_triplet_s triplet;
	if (!_triplet_sub.update(&triplet)) return;
	fga_mission way {sizeof(fga_mission), 0, _way, -(double)INFINITY, (double)INFINITY};
	for (const position_setpoint_s *at : {&triplet.previous, &triplet.current, &triplet.next}) {
		if (!at->valid || at->type != position_setpoint_s::SETPOINT_TYPE_POSITION) break;
		_way[way.waypoint_count++] = fga_waypoint{enu(at->lat, at->lon, at->alt), FGA_PASSING_FLY_BY};
	}
	(void)fga_task_set_mission(&_task, &way, &_task.why);
}

void Fga::set_nav_state(uint8_t nav_state) {
	vehicle_command_s command {};
	command.timestamp = hrt_absolute_time();
	command.command = vehicle_command_s::VEHICLE_CMD_SET_NAV_STATE;
	command.param1 = nav_state;
	command.target_system = command.source_system = _status.system_id;
	command.target_component = command.source_component = _status.component_id;
	_command_pub.publish(command);
}

void Fga::step() {
	_status_sub.update(&_status);
	_attitude_sub.update(&_attitude);
	_wind_sub.update(&_wind);
	_sticks_sub.update(&_sticks);
	fga_task_input in {};
	in.time_s = hrt_absolute_time() / 1000000.0;
	const bool is_new = _local_sub.update(&_local);
	if (!register_mode() || !_local.xy_global) return;
	if (!_map.isInitialized()) {
		_map.initReference(_local.ref_lat, _local.ref_lon, hrt_absolute_time());
		_map_altitude_m = _local.ref_alt;
	}
	const bool is_mission = _status.nav_state == vehicle_status_s::NAVIGATION_STATE_AUTO_MISSION;
	if (is_mission) follow_mission();
	in.mode = is_mission && _task.mission.waypoint_count >= 2 ? FGA_TASK_MODE_MISSION
	          : _status.nav_state == _mode_id                 ? FGA_TASK_MODE_AVOID : FGA_TASK_MODE_OTHER;
	in.is_fresh = is_new && _local.xy_valid && _local.v_xy_valid;
	in.pilot_hand = _sticks.valid && _sticks.sticks_moving;
	in.wind_mps = fga_enu{_wind.windspeed_east, _wind.windspeed_north, 0};
	const double east_mps = _local.vy - in.wind_mps.east, north_mps = _local.vx - in.wind_mps.north;
	in.ownship.position_m = fga_enu{_local.y, _local.x, -_local.z};
	in.ownship.course_from_east_rad = atan2(north_mps, east_mps);
	in.ownship.climb_rad = atan2((double)-_local.vz, hypot(east_mps, north_mps));
	in.ownship.airspeed_mps = hypot(hypot(east_mps, north_mps), (double)_local.vz);
	in.ownship.bank_left_rad = -matrix::Eulerf(matrix::Quatf(_attitude.q)).phi();

	transponder_report_s other;
	while (_traffic_sub.update(&other)) {
		const fga_report report {sizeof(fga_report), other.icao_address, FGA_MOVEMENT_CREWED, 1, other.timestamp / 1000000.0 - other.tslc,
			enu(other.lat, other.lon, other.altitude),
			{other.hor_velocity * sin((double)other.heading), other.hor_velocity * cos((double)other.heading), other.ver_velocity}, 15, 1, 0, 0, 0};
		fga_task_hear(&_task, &report, in.time_s);
	}
	fga_task_output out;
	fga_task_step(&_task, &in, &out);
	if (out.request == FGA_TASK_REQUEST_AVOID) set_nav_state(_mode_id);
	if (out.request == FGA_TASK_REQUEST_MISSION) set_nav_state(vehicle_status_s::NAVIGATION_STATE_AUTO_MISSION);
	if (out.commands) {
		fixed_wing_lateral_setpoint_s lateral {};
		lateral.timestamp = hrt_absolute_time();
		lateral.course = lateral.airspeed_direction = NAN;
		lateral.lateral_acceleration = (float)(-9.80665 * tan(out.bank_left_rad));
		_lateral_pub.publish(lateral);
		fixed_wing_longitudinal_setpoint_s longitudinal {};
		longitudinal.timestamp = lateral.timestamp;
		longitudinal.altitude = (float)(out.altitude_m + _map_altitude_m);
		longitudinal.height_rate = longitudinal.equivalent_airspeed = longitudinal.pitch_direct = longitudinal.throttle_direct = NAN;
		_longitudinal_pub.publish(longitudinal);
	}
	if (out.alarms & ~_alarms) PX4_WARN("%s", fga_task_alarm_text(out.alarms & ~_alarms));
	_alarms = out.alarms;
}

static int run(int, char **) {
	static Fga fga;
	if (!fga.begin(25.0, 0.75, 0.7)) return 1;  // airspeed, bank, turn-rate factor of your aircraft
	for (;;) {
		fga.step();
		px4_usleep(100000);
	}
}

extern "C" __EXPORT int fga_main(int argc, char *argv[]) {
	return px4_task_spawn_cmd("fga", SCHED_DEFAULT, SCHED_PRIORITY_DEFAULT, 14000, run, nullptr) < 0;
}
