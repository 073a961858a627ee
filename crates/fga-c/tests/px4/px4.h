// A stub for a test, of our own: the names of PX4 that the module uses. Each topic keeps its last message and counts them.
#pragma once

#include <math.h>
#include <stdint.h>
#include <stdio.h>

#include <vector>

typedef uint64_t hrt_abstime;
extern hrt_abstime now_us;
inline hrt_abstime hrt_absolute_time() { return now_us; }
#define PX4_ERR(...) (printf("[" __VA_ARGS__), printf("]\n"))
#define PX4_WARN(...) (printf("[" __VA_ARGS__), printf("]\n"))
#define __EXPORT
enum { SCHED_DEFAULT, SCHED_PRIORITY_DEFAULT };
int px4_task_spawn_cmd(const char *name, int scheduler, int priority, int stack, int (*run)(int, char **), char *const *arguments);
int px4_usleep(unsigned us);

struct orb_metadata {
	std::vector<std::vector<unsigned char>> messages;
};
#define ORB_ID(name) (&orb_##name)

namespace uORB {
class Subscription {
public:
	explicit Subscription(orb_metadata *topic) : _topic(topic) {}
	template <class T> bool update(T *into) {
		if (_seen >= _topic->messages.size()) return false;
		*into = *reinterpret_cast<const T *>(_topic->messages[_seen++].data());
		return true;
	}

private:
	orb_metadata *_topic;
	size_t _seen = 0;
};
template <class T> class Publication {
public:
	explicit Publication(orb_metadata *topic) : _topic(topic) {}
	void publish(const T &message) {
		const unsigned char *bytes = reinterpret_cast<const unsigned char *>(&message);
		_topic->messages.push_back(std::vector<unsigned char>(bytes, bytes + sizeof(T)));
	}

private:
	orb_metadata *_topic;
};
}

namespace matrix {
struct Quatf {
	explicit Quatf(const float *from) : w(from[0]), x(from[1]), y(from[2]), z(from[3]) {}
	float w, x, y, z;
};
struct Eulerf {
	explicit Eulerf(const Quatf &q) : roll(atan2f(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x * q.x + q.y * q.y))) {}
	float phi() const { return roll; }
	float roll;
};
}

// A flat earth at 38 degrees north.
class MapProjection {
public:
	bool isInitialized() const { return _is_known; }
	void initReference(double lat, double lon, uint64_t) { _lat = lat, _lon = lon, _is_known = true; }
	void project(double lat, double lon, float &x, float &y) const {
		x = (float)((lat - _lat) * 111318.8);
		y = (float)((lon - _lon) * 111318.8 * 0.79);
	}

private:
	bool _is_known = false;
	double _lat = 0, _lon = 0;
};

struct vehicle_status_s {
	enum { NAVIGATION_STATE_AUTO_MISSION = 3, NAVIGATION_STATE_POSCTL = 2, NAVIGATION_STATE_EXTERNAL1 = 23 };
	uint64_t timestamp;
	uint8_t nav_state, system_id, component_id;
};
struct vehicle_local_position_s {
	uint64_t timestamp;
	bool xy_valid, v_xy_valid, xy_global;
	float x, y, z, vx, vy, vz;
	double ref_lat, ref_lon;
	float ref_alt;
};
struct vehicle_attitude_s {
	uint64_t timestamp;
	float q[4];
};
struct wind_s {
	uint64_t timestamp;
	float windspeed_north, windspeed_east;
};
struct manual_control_setpoint_s {
	uint64_t timestamp;
	bool valid, sticks_moving;
};
struct position_setpoint_s {
	enum { SETPOINT_TYPE_POSITION = 0, SETPOINT_TYPE_LAND = 4 };
	bool valid;
	uint8_t type;
	double lat, lon;
	float alt;
};
struct position_setpoint_triplet_s {
	uint64_t timestamp;
	position_setpoint_s previous, current, next;
};
struct transponder_report_s {
	uint64_t timestamp;
	uint32_t icao_address;
	double lat, lon;
	float altitude, heading, hor_velocity, ver_velocity;
	uint8_t tslc;
};
struct register_ext_component_request_s {
	static constexpr uint16_t LATEST_PX4_ROS2_API_VERSION = 1;
	uint64_t timestamp, request_id;
	char name[25];
	uint16_t px4_ros2_api_version;
	bool register_arming_check, register_mode, not_user_selectable;
};
struct register_ext_component_reply_s {
	uint64_t timestamp, request_id;
	char name[25];
	bool success;
	int8_t arming_check_id, mode_id;
};
struct arming_check_request_s {
	uint64_t timestamp;
	uint8_t request_id;
};
struct arming_check_reply_s {
	uint64_t timestamp;
	uint8_t request_id, registration_id;
	bool can_arm_and_run, mode_req_local_position, mode_req_local_alt, mode_req_attitude;
};
struct vehicle_control_mode_s {
	uint64_t timestamp;
	bool flag_control_position_enabled, flag_control_velocity_enabled, flag_control_altitude_enabled, flag_control_climb_rate_enabled,
		flag_control_acceleration_enabled, flag_control_attitude_enabled, flag_control_rates_enabled, flag_control_allocation_enabled;
	uint8_t source_id;
};
struct vehicle_command_s {
	static constexpr uint32_t VEHICLE_CMD_SET_NAV_STATE = 100001;
	uint64_t timestamp;
	float param1;
	uint32_t command;
	uint8_t target_system, target_component, source_system;
	uint16_t source_component;
};
struct fixed_wing_lateral_setpoint_s {
	uint64_t timestamp;
	float course, airspeed_direction, lateral_acceleration;
};
struct fixed_wing_longitudinal_setpoint_s {
	uint64_t timestamp;
	float altitude, height_rate, equivalent_airspeed, pitch_direct, throttle_direct;
};

extern orb_metadata orb_vehicle_status, orb_vehicle_local_position, orb_vehicle_attitude, orb_wind, orb_manual_control_setpoint,
	orb_position_setpoint_triplet, orb_transponder_report, orb_register_ext_component_request, orb_register_ext_component_reply,
	orb_arming_check_request, orb_arming_check_reply, orb_config_control_setpoints, orb_vehicle_command, orb_fixed_wing_lateral_setpoint,
	orb_fixed_wing_longitudinal_setpoint;
