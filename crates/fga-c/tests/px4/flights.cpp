// The module inside PX4's stub, on a plant: see tests/task.rs. Commander, navigator and controllers are as short as the test allows.
#include "px4.h"

#include <stdlib.h>
#include <string.h>

hrt_abstime now_us = 0;
orb_metadata orb_vehicle_status, orb_vehicle_local_position, orb_vehicle_attitude, orb_wind, orb_manual_control_setpoint,
	orb_position_setpoint_triplet, orb_transponder_report, orb_register_ext_component_request, orb_register_ext_component_reply,
	orb_arming_check_request, orb_arming_check_reply, orb_config_control_setpoints, orb_vehicle_command, orb_fixed_wing_lateral_setpoint,
	orb_fixed_wing_longitudinal_setpoint;

extern "C" int fga_main(int argc, char *argv[]);

static const double LATITUDE = 37.6189, LONGITUDE = -122.375, METRES = 111318.8, NARROW = 0.79;
static const float ALTITUDE = 104.0f;  // of the mission, above the sea; the reference is at 4 m
static const uint8_t MODE = vehicle_status_s::NAVIGATION_STATE_EXTERNAL1;
static const char *fault = "none";
static double wind_mps = 0, east_m, north_m, up_m = 100, course_rad = 0, climb_rad, bank_left_rad, airspeed_mps = 25;
static double least_m = 1e9, taken_s = 1e9, back_s = 1e9, beside_m = 0, last_right_rad = 0, asked_altitude_m = ALTITUDE;
static int steps = 0, changes = 0, answers = 0;
static uint8_t nav_state = vehicle_status_s::NAVIGATION_STATE_AUTO_MISSION;
static uORB::Subscription asked(&orb_register_ext_component_request), configured(&orb_config_control_setpoints), commands(&orb_vehicle_command),
	checks(&orb_arming_check_reply), lateral(&orb_fixed_wing_lateral_setpoint), longitudinal(&orb_fixed_wing_longitudinal_setpoint);

template <class T> static void send(orb_metadata *topic, const T &message) { uORB::Publication<T>(topic).publish(message); }

static position_setpoint_s place(double at_east_m, uint8_t type) {
	return {true, type, LATITUDE, LONGITUDE + at_east_m / METRES / NARROW, ALTITUDE};
}

static void sense(bool is_silent) {
	vehicle_status_s status {};
	status.nav_state = nav_state;
	status.system_id = status.component_id = 1;
	send(&orb_vehicle_status, status);
	if (!is_silent) {
		const double level_mps = airspeed_mps * cos(climb_rad);
		send(&orb_vehicle_local_position, vehicle_local_position_s{now_us, true, true, true, (float)north_m, (float)east_m, (float)-up_m,
			(float)(level_mps * sin(course_rad) + wind_mps), (float)(level_mps * cos(course_rad)), (float)(-airspeed_mps * sin(climb_rad)),
			LATITUDE, LONGITUDE, 4.0f});
		send(&orb_vehicle_attitude, vehicle_attitude_s{now_us, {(float)cos(bank_left_rad / 2), (float)-sin(bank_left_rad / 2), 0, 0}});
	}
	send(&orb_wind, wind_s{now_us, (float)wind_mps, 0});
	// A leg of 4 km to the east, then another one.
	const uint8_t last = strcmp(fault, "landing") ? position_setpoint_s::SETPOINT_TYPE_POSITION : position_setpoint_s::SETPOINT_TYPE_LAND;
	if (steps == 0) send(&orb_position_setpoint_triplet, position_setpoint_triplet_s{0, place(0, 0), place(4000, last), place(8000, last)});
	if (steps % 10 == 0) send(&orb_arming_check_request, arming_check_request_s{now_us, (uint8_t)(steps / 10)});
}

// Commander: modes that exist are entered, and none else.
static void command() {
	register_ext_component_request_s request;
	while (asked.update(&request)) {
		register_ext_component_reply_s reply {now_us, request.request_id, "", true, 5, (int8_t)MODE};
		memcpy(reply.name, request.name, sizeof reply.name);
		send(&orb_register_ext_component_reply, reply);
	}
	arming_check_reply_s check;
	while (checks.update(&check)) answers += check.registration_id == 5 && check.can_arm_and_run;
	vehicle_command_s to;
	while (commands.update(&to)) {
		vehicle_control_mode_s flags {};
		if (to.command != vehicle_command_s::VEHICLE_CMD_SET_NAV_STATE || (!strcmp(fault, "refused") && to.param1 == MODE)) continue;
		if (to.param1 == MODE && changes == 0 && (!configured.update(&flags) || flags.source_id != MODE)) continue;
		changes += nav_state != (uint8_t)to.param1;
		nav_state = (uint8_t)to.param1;
	}
}

int px4_usleep(unsigned us) {
	const double now_s = steps * 0.1, meets_m = 1250.0 + 20.0 * (50.0 - now_s);
	command();
	if (nav_state == MODE && taken_s > 1e8) taken_s = now_s;
	if (nav_state == vehicle_status_s::NAVIGATION_STATE_AUTO_MISSION && taken_s < 1e8 && back_s > 1e8) {
		back_s = now_s;
		beside_m = fabs(north_m);
	}
	double right_rad = fmax(-0.6, fmin(0.6, 1.2 * (course_rad + fmax(-0.8, fmin(0.8, 0.008 * north_m)))));
	if (nav_state == MODE) {
		fixed_wing_lateral_setpoint_s to;
		fixed_wing_longitudinal_setpoint_s hold;
		while (lateral.update(&to)) last_right_rad = atan(to.lateral_acceleration / 9.80665);
		while (longitudinal.update(&hold)) asked_altitude_m = hold.altitude;
		right_rad = last_right_rad;
	}
	printf("fly %.17g 0 %.17g\n", -right_rad, nav_state == MODE ? asked_altitude_m - 4.0 : 100.0);
	fflush(stdout);
	if (scanf("%lf %lf %lf %lf %lf %lf %lf", &east_m, &north_m, &up_m, &course_rad, &climb_rad, &bank_left_rad, &airspeed_mps) != 7) exit(2);
	least_m = fmin(least_m, hypot(meets_m - east_m, north_m));
	if (++steps == 1000) {
		printf("least %.1f taken %.1f back %.1f beside %.1f changes %d answers %d\n", least_m, taken_s, back_s, beside_m, changes, answers);
		exit(0);
	}
	now_us += us;
	const bool fails = steps * 0.1 >= taken_s + 2.0;
	if (fails && !strcmp(fault, "pilot")) nav_state = vehicle_status_s::NAVIGATION_STATE_POSCTL;
	const bool moves = fails && !strcmp(fault, "stick") && steps * 0.1 < taken_s + 6.0;
	send(&orb_manual_control_setpoint, manual_control_setpoint_s{now_us, true, moves});
	sense(fails && !strcmp(fault, "state"));
	if (steps % 10 == 0 && !(fails && !strcmp(fault, "silent"))) {
		send(&orb_transponder_report, transponder_report_s{now_us, 0xABC123, LATITUDE, LONGITUDE + (meets_m - 2.0) / METRES / NARROW, ALTITUDE,
			(float)(1.5 * M_PI), 20, 0, 0});
	}
	return 0;
}

int px4_task_spawn_cmd(const char *, int, int, int, int (*run)(int, char **), char *const *) { return run(0, nullptr) ? -1 : 0; }

int main(int count, char **arguments) {
	if (count > 1) fault = arguments[1];
	if (count > 2) wind_mps = atof(arguments[2]);
	printf("new %.17g\n", wind_mps);
	now_us = 5000000;
	sense(false);
	return fga_main(0, nullptr);
}
