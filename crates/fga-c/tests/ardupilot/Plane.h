// A stub for a test, of our own: the names of ArduPlane that the glue uses, on a plane that flies lines and forced banks.
#pragma once

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>

#include <string>
#include <vector>

#include "fga_plane.h"

#ifdef ALLOW_DOUBLE_MATH_FUNCTIONS
#error ArduPilot refuses this name
#endif

struct Vector3f {
    float x, y, z;
    Vector3f(float a = 0, float b = 0, float c = 0) : x(a), y(b), z(c) {}
    Vector3f operator-(const Vector3f &other) const { return Vector3f(x - other.x, y - other.y, z - other.z); }
    float length() const { return sqrtf(x * x + y * y + z * z); }
};
struct Vector3l {
    int32_t x, y, z;
};
inline float radians(float deg) { return deg * 0.017453292f; }
inline float degrees(float rad) { return rad * 57.29578f; }
inline float sq(float x) { return x * x; }
#define MIN(a, b) ((a) < (b) ? (a) : (b))

namespace AP_HAL {
extern uint32_t now_ms;
inline uint32_t millis() { return now_ms; }
inline uint64_t micros64() { return (uint64_t)now_ms * 1000; }
}

struct Location {
    enum class AltFrame { ABSOLUTE, ABOVE_HOME };
    int32_t lat = 0, lng = 0, alt = 0;  // 1e-7 deg, 1e-7 deg, cm
    AltFrame frame = AltFrame::ABSOLUTE;
    static constexpr double METRES = 0.011131884502145034, COS = 0.79;  // a flat earth at 38 deg north
    static constexpr int32_t HOME_CM = 400;
    static Location at(double north_m, double east_m, double up_m) {
        Location place;
        place.lat = 376189000 + (int32_t)lrint(north_m / METRES);
        place.lng = -1223750000 + (int32_t)lrint(east_m / METRES / COS);
        place.alt = HOME_CM + (int32_t)lrint(up_m * 100.0);
        return place;
    }
    Vector3f get_distance_NED(const Location &to) const {
        return Vector3f((float)((to.lat - lat) * METRES), (float)((to.lng - lng) * METRES * COS), (float)(alt - to.alt) * 0.01f);
    }
    bool change_alt_frame(AltFrame to) {
        if (frame == AltFrame::ABOVE_HOME && to == AltFrame::ABSOLUTE) alt += HOME_CM;
        frame = to;
        return true;
    }
};

enum class ModeReason { AVOIDANCE, AVOIDANCE_RECOVERY };
struct Mode {};

enum { MAV_CMD_NAV_WAYPOINT = 16, MAV_CMD_NAV_LAND = 21 };
class AP_Mission {
public:
    struct Mission_Command {
        uint16_t index, id;
        struct {
            Location location;
        } content;
    };
    std::vector<Mission_Command> commands;  // the first is home
    uint16_t current = 1;
    uint32_t changed_ms = 1;
    unsigned sets = 0;
    bool restarts = false, resumes = false;  // MIS_RESTART, and the word against it
    uint16_t get_current_nav_index() const { return current; }
    uint16_t get_current_nav_id() const { return commands[current].id; }
    uint32_t last_change_time_ms() const { return changed_ms; }
    bool set_current_cmd(uint16_t index) { return sets += 1, index < commands.size() ? (current = index, true) : false; }
    void set_force_resume(bool resume) { resumes = resume; }
    void start_or_resume() {
        if (restarts && !resumes) current = 1;
        resumes = false;
    }
    bool get_next_nav_cmd(uint16_t index, Mission_Command &cmd) const {
        return index < commands.size() ? (cmd = commands[index], true) : false;
    }
};

class AP_ADSB {
public:
    struct adsb_vehicle_t {
        struct {
            uint32_t ICAO_address;
            int32_t lat, lon, altitude;  // altitude in mm
            uint16_t heading, hor_velocity;
            int16_t ver_velocity;
        } info;
        uint32_t last_update_ms;
    };
    std::vector<adsb_vehicle_t> samples;
    bool next_sample(adsb_vehicle_t &sample) {
        if (samples.empty()) return false;
        sample = samples.front();
        samples.erase(samples.begin());
        return true;
    }
    Location get_location(const adsb_vehicle_t &sample) const {
        Location place;
        place.lat = sample.info.lat;
        place.lng = sample.info.lon;
        place.alt = sample.info.altitude / 10;
        return place;
    }
};

class AP_AHRS {
public:
    Location home = Location::at(0, 0, 0);
    Vector3f velocity, wind;
    float roll_rad = 0;
    bool is_good = true;
    bool home_is_set() const { return true; }
    const Location &get_home() const { return home; }
    bool get_velocity_NED(Vector3f &into) const { return into = velocity, is_good; }
    bool wind_estimate(Vector3f &into) const { return into = wind, true; }
    float get_roll_rad() const { return roll_rad; }
};

struct RC_Channel {
    float stick = 0;
    float norm_input_dz() const { return stick; }
};
struct RC_Channels {
    bool has_valid_input() const { return true; }
};
RC_Channels &rc();

enum { MAV_SEVERITY_CRITICAL = 2, MAV_SEVERITY_WARNING = 4 };
struct GCS {
    std::vector<std::string> texts;
    __attribute__((format(printf, 3, 4))) void send_text(int, const char *format, ...) {
        char text[51];
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(text, sizeof text, format, arguments);
        va_end(arguments);
        texts.push_back(text);
    }
};
GCS &gcs();

struct AP_Logger {
    unsigned rows = 0;
    void Write(const char *name, const char *labels, const char *format, ...) {
        if (name && labels && format) rows += 1;
    }
};
namespace AP {
AP_Logger &logger();
}

class Plane {
    friend class FgaPlane;
    friend struct Flight;
    struct {
        AP_Float airspeed_cruise, roll_limit;
        AP_Int16 airspeed_min;
    } aparm;
    Mode mode_auto, mode_avoidADSB, mode_fbwa;
    Mode *control_mode = &mode_auto;
    AP_Mission mission;
    AP_ADSB adsb;
    AP_AHRS ahrs;
    Location current_loc, prev_WP_loc;
    RC_Channel roll_channel, *channel_roll = &roll_channel;
    struct {
        Vector3l forced_rpy_cd;
        struct {
            uint32_t x, y, z;
        } last_forced_rpy_ms;
    } guided_state {};
    FgaPlane fga;

    bool refuses_avoid = false;
    unsigned changes = 0;
    bool set_mode(Mode &to, ModeReason) {
        if (refuses_avoid && &to == &mode_avoidADSB) return false;
        if (control_mode == &to) return true;
        changes += 1;
        prev_WP_loc = current_loc;
        if (&to == &mode_auto) mission.start_or_resume();
        control_mode = &to;
        return true;
    }
};
extern Plane plane;
