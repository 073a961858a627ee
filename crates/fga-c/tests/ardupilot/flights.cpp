// The glue inside ArduPlane's stub, on a plant: see tests/autopilots.rs.
#include "Plane.h"

#include <stdlib.h>
#include <string.h>

Plane plane;
namespace AP_HAL {
uint32_t now_ms = 0;
}
static GCS ground;
static AP_Logger log_file;
static RC_Channels channels;
GCS &gcs() { return ground; }
AP_Logger &AP::logger() { return log_file; }
RC_Channels &rc() { return channels; }

static double east_m, north_m, up_m, course_rad, climb_rad, bank_left_rad, airspeed_mps;

static void fly(double bank_right_rad, double altitude_m) {
    printf("fly %.17g 0 %.17g\n", -bank_right_rad, altitude_m);
    fflush(stdout);
    if (scanf("%lf %lf %lf %lf %lf %lf %lf", &east_m, &north_m, &up_m, &course_rad, &climb_rad, &bank_left_rad, &airspeed_mps) != 7) exit(2);
}

// Flies the plane's modes.
struct Flight {
    static void sense(double wind_north_mps);
    static double auto_bank_rad();
    static int fly_with(const char *fault, double wind_mps);
};

void Flight::sense(double wind_north_mps) {
    plane.current_loc = Location::at(north_m, east_m, up_m);
    const double level_mps = airspeed_mps * cos(climb_rad);
    plane.ahrs.velocity = Vector3f((float)(level_mps * sin(course_rad) + wind_north_mps), (float)(level_mps * cos(course_rad)),
                                   (float)(-airspeed_mps * sin(climb_rad)));
    plane.ahrs.wind = Vector3f((float)wind_north_mps, 0, 0);
    plane.ahrs.roll_rad = (float)-bank_left_rad;
}

// AUTO: along the line to the present waypoint.
double Flight::auto_bank_rad() {
    AP_Mission &mission = plane.mission;
    const Location home = plane.ahrs.get_home(), next = mission.commands[mission.current].content.location;
    Vector3f to = home.get_distance_NED(next), from = home.get_distance_NED(plane.prev_WP_loc);
    if (hypot(to.x - north_m, to.y - east_m) < 90.0 && mission.current + 1u < mission.commands.size()) {
        plane.prev_WP_loc = next;
        plane.prev_WP_loc.change_alt_frame(Location::AltFrame::ABSOLUTE);
        mission.current += 1;
        return auto_bank_rad();
    }
    const double line_rad = atan2(to.x - from.x, to.y - from.y);
    const double left_m = cos(line_rad) * (north_m - from.x) - sin(line_rad) * (east_m - from.y);
    const double off_rad = remainder(course_rad - line_rad, 2.0 * M_PI);
    return fmax(-0.6, fmin(0.6, 1.2 * (off_rad + fmax(-0.8, fmin(0.8, 0.008 * left_m)))));
}

int Flight::fly_with(const char *fault, double wind_mps) {
    const double places[][2] = {{0, 0}, {0, 1500}, {2500, 1500}};  // north, east
    for (uint16_t k = 0; k < 3; ++k) {
        AP_Mission::Mission_Command command {k, MAV_CMD_NAV_WAYPOINT, {Location::at(places[k][0], places[k][1], 100)}};
        command.content.location.alt -= Location::HOME_CM;
        command.content.location.frame = Location::AltFrame::ABOVE_HOME;
        plane.mission.commands.push_back(command);
    }
    plane.prev_WP_loc = plane.current_loc = Location::at(0, 0, 100);
    if (!strcmp(fault, "landing")) plane.mission.commands[2].id = MAV_CMD_NAV_LAND;
    plane.refuses_avoid = !strcmp(fault, "refused");
    plane.mission.restarts = !strcmp(fault, "restart");
    plane.aparm.airspeed_cruise.set(25);
    plane.aparm.airspeed_min.set(10);
    plane.aparm.roll_limit.set(65);
    FgaPlane &fga = plane.fga;
    for (const AP_Param::GroupInfo *info = FgaPlane::var_info; info->name; ++info) {
        if (!strcmp(info->name, "ENABLE")) info->set(&fga, 1);
        if (!strcmp(info->name, "FACTOR") && !strcmp(fault, "factor")) info->set(&fga, 5);
    }

    printf("new %.17g\n", wind_mps);
    up_m = 100;
    airspeed_mps = 25;
    double least_m = 1e9, taken_s = 1e9, back_s = 1e9, beside_m = 0, steepest_deg = 0;
    unsigned item = 0;
    Location taken;
    for (int step = 0; step < 1400; ++step) {
        const double now_s = step * 0.1;
        AP_HAL::now_ms = (uint32_t)step * 100 + 5000;
        sense(wind_mps);
        // Head-on on the second leg at 100 s.
        const double other_north_m = 1000.0 + 20.0 * (100.0 - now_s), other_east_m = 1500.0;
        const int fails = now_s >= taken_s + 2.0;
        const double apart_m = hypot(other_north_m - north_m, other_east_m - east_m);
        const int is_shown = !(fails && !strcmp(fault, "silent")) && (strcmp(fault, "late") || apart_m < 230.0);
        if (step % 10 == 0 && is_shown) {
            const Location at = Location::at(other_north_m, other_east_m, 100);
            const AP_ADSB::adsb_vehicle_t sample {{0xABC123, at.lat, at.lng, at.alt * 10, 18000, 2000, 0}, AP_HAL::now_ms};
            plane.adsb.samples.push_back(sample);
        }
        if (fails && now_s < taken_s + 6.0 && !strcmp(fault, "pilot")) plane.control_mode = &plane.mode_fbwa;
        if (fails && !strcmp(fault, "mission") && plane.mission.changed_ms == 1) {
            plane.mission.changed_ms = AP_HAL::now_ms;
            plane.mission.commands[2].content.location = Location::at(2500, 2100, 100);
        }
        plane.roll_channel.stick = fails && now_s < taken_s + 6.0 && !strcmp(fault, "stick") ? 0.5f : 0.0f;
        plane.ahrs.is_good = !(fails && !strcmp(fault, "state"));
        if (!(fails && !strcmp(fault, "stopped"))) fga.update();
        for (int k = 0; k < 5; ++k) fga.watch();
        if (plane.control_mode == &plane.mode_avoidADSB && taken_s > 1e8) {
            taken_s = now_s;
            taken = plane.current_loc;
        }
        if (plane.control_mode == &plane.mode_auto && taken_s < 1e8 && back_s > 1e8) {
            back_s = now_s;
            const Vector3f leg = taken.get_distance_NED(plane.mission.commands[2].content.location), at = taken.get_distance_NED(plane.current_loc);
            beside_m = fabs(leg.x * at.y - leg.y * at.x) / hypot(leg.x, leg.y);
            item = plane.mission.current;
        }
        if (plane.control_mode == &plane.mode_avoidADSB) {
            const int is_fresh = AP_HAL::now_ms - plane.guided_state.last_forced_rpy_ms.x < 3000;
            fly(is_fresh ? radians(plane.guided_state.forced_rpy_cd.x * 0.01f) : 0.0, 100.0);
        } else {
            fly(plane.control_mode == &plane.mode_auto ? auto_bank_rad() : 0.0, 100.0);
        }
        least_m = fmin(least_m, hypot(other_north_m - north_m, other_east_m - east_m));
        steepest_deg = fmax(steepest_deg, fabs(plane.guided_state.forced_rpy_cd.x * 0.01));
    }
    printf("least %.1f taken %.1f back %.1f beside %.1f steepest %.1f item %u sets %u changes %u rows %u texts", least_m, taken_s, back_s, beside_m, steepest_deg, item, plane.mission.sets,
           plane.changes, log_file.rows);
    for (const std::string &text : ground.texts) printf(" [%s]", text.c_str());
    printf("\n");
    return 0;
}

int main(int count, char **arguments) {
    return Flight::fly_with(count > 1 ? arguments[1] : "none", count > 2 ? atof(arguments[2]) : 0.0);
}
