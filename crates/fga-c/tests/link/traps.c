// Drawn flights with floating-point traps on, as ArduPilot's simulator sets them: invalid operations, divisions by zero and
// overflows end the program. Each flies twice, once with steps that are called while numbers are rounded upwards: the decisions are
// the same.
//
//   traps FIRST COUNT    flies the worlds FIRST to FIRST + COUNT - 1
#define _GNU_SOURCE
#include "fga.h"

#include <fenv.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { OBSTACLES = 14, WAYPOINTS = 8, ZONES = 4, POSTS = 33, STEPS = 40 };

static _Alignas(FGA_ALIGN) unsigned char storage[FGA_AVOIDER_BYTES(OBSTACLES, WAYPOINTS)];
static _Alignas(FGA_ALIGN) unsigned char proof[FGA_PROVER_BYTES];
static _Alignas(FGA_ALIGN) unsigned char evidence[FGA_LEARNED_BYTES];
static _Alignas(FGA_ALIGN) unsigned char believed[FGA_BELIEFS_BYTES];
static fga_refusal why = {.size = sizeof why};

static unsigned long world, maneuvers;
static unsigned long long drawn;

// What cannot be printed with care after a trap.
static void trapped(int signal, siginfo_t *info, void *context) {
  (void)signal;
  (void)context;
  dprintf(2, "world %lu: code %d at %p\n", world, info->si_code, info->si_addr);
  _exit(3);
}

// A number from 0 to 1 (xorshift).
static double unit(void) {
  drawn ^= drawn << 13;
  drawn ^= drawn >> 7;
  drawn ^= drawn << 17;
  return (double)(drawn >> 11) * 0x1p-53;
}

static double between(double low, double high) { return low + (high - low) * unit(); }

static int one_in(int count) { return unit() * count < 1.0; }

static fga_enu place(double reach_m) {
  return (fga_enu){between(-reach_m, reach_m), between(-reach_m, reach_m), 100.0 + (one_in(2) ? 0.0 : between(-60.0, 60.0))};
}

static void done(const char *call, fga_status status) {
  if (status > FGA_STATUS_INCOMPLETE) {
    feclearexcept(FE_ALL_EXCEPT);
    fprintf(stderr, "world %lu: %s: %s: %s %g\n", world, call, fga_status_text(status), why.field, why.value);
    exit(2);
  }
}

static fga_vehicle draw_vehicle(void) {
  fga_vehicle vehicle = {.size = sizeof vehicle};
  done("vehicle", fga_vehicle_from_bank(between(8.0, 60.0), between(0.3, 1.1), &vehicle, &why));
  if (!one_in(3)) {
    vehicle.climb_max_rad = between(0.05, 0.3);
    vehicle.climb_min_rad = one_in(4) ? 0.0 : -between(0.05, 0.3);
    vehicle.climb_rate_radps = one_in(6) ? 0.0 : between(0.05, 0.5);
  }
  if (!one_in(3)) {
    vehicle.turn_rate_factor = between(0.7, 1.2);
    // No turn of more than 1.5 rad within the time constant.
    double most_s = 1.5 * vehicle.turn_radius_m / (vehicle.turn_rate_factor * vehicle.airspeed_mps);
    vehicle.bank_time_constant_s = between(0.05, most_s < 2.0 ? most_s : 2.0);
  }
  return vehicle;
}

static fga_obstacle draw_obstacle(uint32_t id, const fga_ownship *own, fga_enu wind_mps) {
  fga_obstacle row = {.size = sizeof row, .id = id, .volume = 1 + (uint32_t)one_in(2), .movement = 1 + (uint32_t)(unit() * 5.0)};
  double course_rad = between(-4.0, 4.0), speed_mps = one_in(5) ? 0.0 : between(0.0, 70.0);
  row.position_m = place(one_in(4) ? 150.0 : 2000.0);
  row.velocity_mps = (fga_enu){speed_mps * cos(course_rad), speed_mps * sin(course_rad), one_in(2) ? 0.0 : between(-4.0, 4.0)};
  if (one_in(12)) {  // Alongside, at the very same velocity.
    row.velocity_mps = (fga_enu){own->airspeed_mps * cos(own->course_from_east_rad) + wind_mps.east,
                                 own->airspeed_mps * sin(own->course_from_east_rad) + wind_mps.north, 0.0};
  } else if (one_in(12)) {  // In the air at rest.
    row.velocity_mps = wind_mps;
  }
  if (one_in(10)) {  // Ahead, above or at the aircraft itself.
    row.position_m = own->position_m;
    row.position_m.east += one_in(2) ? 0.0 : 400.0;
    row.position_m.up += one_in(2) ? 0.0 : 80.0;
  }
  row.radius_m = one_in(10) ? 0.0 : between(5.0, 200.0);
  row.half_height_m = one_in(10) ? 0.0 : between(5.0, 60.0);
  row.position_sigma_m = one_in(2) ? 0.0 : between(0.0, 20.0);
  row.velocity_sigma_mps = one_in(2) ? 0.0 : between(0.0, 2.0);
  if (row.movement == FGA_MOVEMENT_AT_REST && row.velocity_sigma_mps == 0.0) {
    row.velocity_mps = (fga_enu){0.0, 0.0, 0.0};
  }
  row.age_s = one_in(2) ? 0.0 : between(-0.2, 4.0);
  row.bounds = (fga_bounds){one_in(3) ? 0.0 : between(0.0, 0.3), one_in(3) ? 0.0 : between(0.3, 0.7), one_in(3) ? 0.0 : between(0.0, 2.0),
                            one_in(3) ? 0.0 : between(0.0, 4.0), one_in(3) ? 0.0 : between(0.0, 2.0)};
  return row;
}

static uint32_t draw_zones(fga_zone *zones, fga_place corners[ZONES][5]) {
  uint32_t count = one_in(2) ? 0 : 1 + (uint32_t)(unit() * ZONES);
  for (uint32_t at = 0; at < count; ++at) {
    double size_m = between(50.0, 900.0);
    fga_zone zone = {.kind = (uint32_t)one_in(4), .radius_m = size_m, .floor_m = one_in(2) ? -INFINITY : 60.0, .ceiling_m = one_in(2) ? INFINITY : 160.0};
    zone.center = (fga_place){between(-1500.0, 1500.0), between(-1500.0, 1500.0)};
    if (zone.kind == FGA_ZONE_KIND_KEEP_IN) {
      zone.radius_m = 2500.0;
    }
    if (!one_in(3)) {
      zone.corner_count = 3 + (uint32_t)(unit() * 3.0);
      zone.corners = corners[at];
      for (uint32_t corner = 0; corner < zone.corner_count; ++corner) {
        double around_rad = 6.28 * corner / zone.corner_count;
        corners[at][corner] = (fga_place){zone.center.east_m + zone.radius_m * cos(around_rad), zone.center.north_m + zone.radius_m * sin(around_rad)};
      }
      if (one_in(8)) {  // An edge of no length.
        corners[at][1] = corners[at][0];
      }
    }
    zones[at] = zone;
  }
  return count;
}

// Whether there is a ground.
static int draw_ground(fga_ground *ground) {
  static float heights_m[POSTS * POSTS], peaks_m[4 * POSTS * POSTS];
  double slope = between(-0.05, 0.05), hill_m = between(0.0, 90.0);
  int is_holed = one_in(3), is_flat = one_in(3);
  for (int row = 0; row < POSTS; ++row) {
    for (int column = 0; column < POSTS; ++column) {
      double height_m = is_flat ? 0.0 : hill_m * sin(0.4 * row) * cos(0.3 * column) + slope * 60.0 * row - 20.0;
      heights_m[row * POSTS + column] = is_holed && one_in(9) ? NAN : (float)height_m;
    }
  }
  *ground = (fga_ground){sizeof *ground, POSTS, POSTS, {-2000.0, -2000.0}, {125.0, 125.0}, heights_m, peaks_m, 5.0, 20.0};
  if (fga_ground_peak_count(POSTS, POSTS) > sizeof peaks_m / sizeof *peaks_m) {
    exit(2);
  }
  done("peaks", fga_ground_fill_peaks(POSTS, POSTS, heights_m, peaks_m));
  return one_in(3);
}

// Learns from a state of turns to both sides, and asks what is known. A vehicle that no proof allows is refused.
static void learn(fga_learned *learned, const fga_ownship *own, double time_s, int step) {
  fga_seen_state seen = {.size = sizeof seen, .has = (uint32_t)step % 4, .time_s = time_s, .airspeed_mps = own->airspeed_mps};
  seen.bank_left_rad = own->bank_left_rad;
  seen.turn_rate_left_radps = 9.0 * tan(own->bank_left_rad) / own->airspeed_mps;
  seen.bank_command_left_rad = step % 20 < 10 ? 0.6 : -0.6;
  seen.velocity_mps = (fga_enu){own->airspeed_mps * cos(own->course_from_east_rad), own->airspeed_mps * sin(own->course_from_east_rad), 0.0};
  fga_known_aircraft known = {.size = sizeof known};
  fga_vehicle vehicle = {.size = sizeof vehicle};
  done("see", fga_learned_see(learned, &seen, &why));
  done("known", fga_learned_known(learned, &known));
  if (fga_learned_vehicle(learned, &vehicle, &why) != FGA_STATUS_OUT_OF_RANGE && !(vehicle.turn_rate_factor > 0.3)) {
    exit(7);
  }
}

// Beliefs hear the aircraft as raw reports.
static void hear(fga_beliefs *beliefs, const fga_obstacle *rows, uint32_t count, const fga_ownship *own, double time_s) {
  for (uint32_t at = 0; at < count; ++at) {
    const fga_obstacle *row = &rows[at];
    fga_report report = {.size = sizeof report, .id = row->id, .movement = row->movement, .has_velocity = (uint32_t)one_in(2), .time_s = time_s};
    if (row->movement != FGA_MOVEMENT_CREWED && row->movement != FGA_MOVEMENT_SMALL_UAS) {
      continue;
    }
    report.position_m = row->position_m;
    report.velocity_mps = row->velocity_mps;
    done("adsb", fga_report_set_adsb(&report, (uint8_t)(unit() * 12.0), (uint8_t)(unit() * 5.0)));
    if (one_in(3)) {
      report.position_sigma_m = report.velocity_sigma_mps = report.altitude_sigma_m = 0.0;
    }
    done("hear", fga_beliefs_hear(beliefs, &report, row->radius_m, row->half_height_m, time_s, own->position_m, &why));
  }
}

// Flies the world; a hash of its decisions.
static unsigned long long fly(int rounding) {
  unsigned long long hash = 14695981039346656037ULL;
  drawn = 0x9E3779B97F4A7C15ULL * (world + 1);
  fga_avoider *avoider;
  fga_prover *prover;
  fga_learned *learned;
  fga_beliefs *beliefs;
  fga_settings settings = {.size = sizeof settings};
  fga_vehicle vehicle = draw_vehicle(), in_need = vehicle;
  done("settings", fga_settings_default(&settings));
  settings.horizon_s = one_in(2) ? 60.0 : between(5.0, 200.0);
  settings.surveillance_radius_m = one_in(2) ? INFINITY : between(200.0, 3000.0);
  settings.drift_mps = one_in(2) ? 0.0 : between(0.0, 1.0);
  settings.margin_m = one_in(3) ? between(0.0, 20.0) : 0.05;
  settings.objective = (uint32_t)(unit() * 3.0);
  settings.start = (uint32_t)(unit() * 4.0);
  settings.start_score = unit();
  settings.work_limit = one_in(4) ? 10000 : 100000;
  done("init", fga_avoider_init(storage, sizeof storage, FGA_ABI_VERSION, OBSTACLES, WAYPOINTS, &settings, &vehicle, &avoider, &why));
  done("prover", fga_prover_init(proof, sizeof proof, FGA_ABI_VERSION, &vehicle, &prover, &why));
  done("learned", fga_learned_init(evidence, sizeof evidence, FGA_ABI_VERSION, &vehicle, &learned, &why));
  done("beliefs", fga_beliefs_init(believed, sizeof believed, FGA_ABI_VERSION, &beliefs, &why));
  int is_believed = one_in(3), are_reports = one_in(2);
  if (one_in(3)) {
    in_need.turn_radius_m *= 0.8;
    in_need.turn_radius_m += vehicle.airspeed_mps * vehicle.airspeed_mps / 90.0;
    in_need.bank_time_constant_s *= 0.8;  // It turns by no more in it than the vehicle.
    done("in need", fga_avoider_set_vehicle_in_need(avoider, &in_need, &why));
  }
  fga_waypoint waypoints[WAYPOINTS];
  for (int at = 0; at < WAYPOINTS; ++at) {
    waypoints[at] = (fga_waypoint){place(1500.0), (uint32_t)one_in(3)};
    if (at > 0 && one_in(10)) {  // At the same place, or above it.
      waypoints[at].position_m = waypoints[at - 1].position_m;
      waypoints[at].position_m.up += one_in(2) ? 0.0 : 10.0;
    } else if (at > 0 && one_in(5)) {
      waypoints[at].position_m.up = waypoints[at - 1].position_m.up;
    }
  }
  fga_mission mission = {sizeof mission, one_in(10) ? (uint32_t)one_in(2) : 2 + (uint32_t)(unit() * (WAYPOINTS - 1)), waypoints,
                         one_in(2) ? -INFINITY : 30.0, one_in(2) ? INFINITY : 170.0};
  done("mission", fga_avoider_set_mission(avoider, &mission, &why));
  double wind_rad = between(-4.0, 4.0), wind = one_in(3) ? 0.0 : between(0.0, one_in(8) ? 1.3 : 0.7) * vehicle.airspeed_mps;
  fga_enu wind_mps = {wind * cos(wind_rad), wind * sin(wind_rad), one_in(4) ? between(-1.0, 1.0) : 0.0};
  fga_ownship own = {waypoints[0].position_m, one_in(2) ? 0.0 : between(-4.0, 4.0), 0.0, 0.0, vehicle.airspeed_mps};
  if (one_in(4)) {
    own.position_m = place(1500.0);
  }
  fga_obstacle rows[OBSTACLES + 2];
  uint32_t count = (uint32_t)(unit() * (one_in(5) ? OBSTACLES + 2.99 : 4.0));
  for (uint32_t at = 0; at < count; ++at) {
    rows[at] = draw_obstacle(at + 1, &own, wind_mps);
  }
  fga_zone zones[ZONES];
  fga_place corners[ZONES][5];
  uint32_t zone_count = draw_zones(zones, corners);
  fga_ground ground;
  int has_ground = draw_ground(&ground);
  double period_s = one_in(2) ? 0.1 : 0.7, time_s = 0.0;
  for (int step = 0; step < STEPS; ++step) {
    fga_situation situation = {sizeof situation, count, rows, time_s, own, wind_mps, zone_count, zones, has_ground ? &ground : NULL};
    fga_decision decision = {.size = sizeof decision};
    if (is_believed && are_reports && step % 3 == 0) {
      hear(beliefs, rows, count, &own, time_s);
    }
    fesetround(rounding);
    fga_status status = is_believed ? fga_avoider_step_on_beliefs(avoider, beliefs, &situation, &decision, &why)
                                    : fga_avoider_step(avoider, &situation, &decision, &why);
    if (fegetround() != rounding) {
      exit(5);
    }
    fesetround(FE_TONEAREST);
    done("step", status);
    for (size_t at = 0; at < sizeof decision; ++at) {
      hash = (hash ^ ((const unsigned char *)&decision)[at]) * 1099511628211ULL;
    }
    maneuvers += decision.state == FGA_STATE_AVOIDING;
    if (step % 10 == 0) {
      fga_question question = {sizeof question, one_in(4) ? 100 : 100000, between(1.0, 100.0), one_in(2) ? 0.0 : between(0.0, 20.0), 3.0};
      fga_certificate certificate = {.size = sizeof certificate};
      done("certify", fga_certify(prover, &situation, decision.stages, decision.stage_count, &question, &certificate, &why));
    }
    if (one_in(30)) {
      done("mission", fga_avoider_set_mission(avoider, &mission, &why));
      mission.waypoint_count = one_in(3) ? 0 : WAYPOINTS;
    } else if (one_in(60)) {
      done("restart", fga_avoider_restart(avoider));
      done("restart", fga_beliefs_restart(beliefs));
    }
    fga_ownship then;
    done("predict", fga_predict(prover, &own, decision.stages, decision.stage_count, wind_mps, period_s, &then, &why));
    learn(learned, &own, time_s, step);
    own = then;
    time_s += period_s;
    for (uint32_t at = 0; at < count; ++at) {
      if (rows[at].movement != FGA_MOVEMENT_AT_REST) {
        rows[at].position_m.east += period_s * rows[at].velocity_mps.east;
        rows[at].position_m.north += period_s * rows[at].velocity_mps.north;
        rows[at].position_m.up += period_s * rows[at].velocity_mps.up;
      }
    }
  }
  return hash;
}

int main(int argc, char **argv) {
  unsigned long first = argc > 1 ? strtoul(argv[1], NULL, 10) : 0, count = argc > 2 ? strtoul(argv[2], NULL, 10) : 1000;
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_sigaction = trapped;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGFPE, &action, NULL);
  feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
  for (world = first; world < first + count; ++world) {
    if (fly(FE_TONEAREST) != fly(FE_UPWARD)) {
      fprintf(stderr, "world %lu: rounding upwards decides otherwise\n", world);
      return 6;
    }
    if (fetestexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW)) {
      fprintf(stderr, "world %lu: a flag is set\n", world);
      return 4;
    }
  }
  printf("%lu flights, %lu decisions to avoid, no trap\n", 2 * count, maneuvers);
  return 0;
}
