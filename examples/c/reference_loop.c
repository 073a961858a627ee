// The reference loop on a simple aircraft: four flights towards an intruder, three of them with a fault.
//
// cc -std=c11 reference_loop.c -I PREFIX/include -L PREFIX/lib -lfga_c -lm
//
// With an argument, its turn-rate factor, another plant flies: it reads `fly BANK CLIMB` and answers a state, once a period.

#include "reference_loop.h"

#include <stdio.h>
#include <stdlib.h>

typedef enum { NO_FAULT, PILOT_TAKES_OVER, STATE_STOPS, STATE_IS_NO_NUMBER } fault;

static const char *const FAULTS[] = {"no fault", "the pilot takes over", "the state stops", "the state is no number"};
static const double PERIOD_S = 0.1, FAULT_FROM_S = 19.0, FAULT_UNTIL_S = 24.0;
static const fga_waypoint LEG[] = {{{0.0, 0.0, 100.0}, FGA_PASSING_FLY_BY}, {{2000.0, 0.0, 100.0}, FGA_PASSING_FLY_BY}};

static _Alignas(FGA_ALIGN) unsigned char storage[FGA_AVOIDER_BYTES(4, 2)];

// The turn-rate factor of another plant; 0 without one.
static double other_factor = 0.0;

// The aircraft for one period: its bank follows with a time constant of 0.5 s, its climb angle with 1 s.
static void fly(fga_ownship *own, loop_set_point to) {
  if (other_factor > 0.0) {
    printf("fly %.17g %.17g\n", to.bank_left_rad, to.climb_rad);
    fflush(stdout);
    fga_enu *at = &own->position_m;
    if (scanf("%lf %lf %lf %lf %lf %lf %lf", &at->east, &at->north, &at->up, &own->course_from_east_rad, &own->climb_rad,
              &own->bank_left_rad, &own->airspeed_mps) != 7) {
      exit(2);
    }
    return;
  }
  const double step_s = 0.01;
  for (int k = 0; k < 10; ++k) {
    own->bank_left_rad += (to.bank_left_rad - own->bank_left_rad) * step_s / 0.5;
    own->climb_rad += (to.climb_rad - own->climb_rad) * step_s / 1.0;
    own->course_from_east_rad += 9.80665 * tan(own->bank_left_rad) / own->airspeed_mps * step_s;
    const double level_m = own->airspeed_mps * cos(own->climb_rad) * step_s;
    own->position_m.east += level_m * cos(own->course_from_east_rad);
    own->position_m.north += level_m * sin(own->course_from_east_rad);
    own->position_m.up += own->airspeed_mps * sin(own->climb_rad) * step_s;
  }
}

// How the autopilot flies its mission: back to the line, at the altitude of the leg.
static loop_set_point mission_set_point(const fga_ownship *own) {
  const double course_rad = fmax(-0.8, fmin(0.8, -0.02 * own->position_m.north));
  loop_set_point to = {.climb_rad = fmax(-0.2, fmin(0.2, 0.02 * (100.0 - own->position_m.up)))};
  to.bank_left_rad = fmax(-0.6, fmin(0.6, 2.0 * (course_rad - own->course_from_east_rad)));
  return to;
}

// One flight; returns what went wrong.
static const char *flight(fault fault) {
  fga_vehicle vehicle = {.size = sizeof(fga_vehicle)};
  fga_settings settings = {.size = sizeof(fga_settings)};
  const fga_mission mission = {
      .size = sizeof(fga_mission), .waypoint_count = 2, .waypoints = LEG, .floor_m = -INFINITY, .ceiling_m = INFINITY};
  fga_avoider *avoider = NULL;
  if (fga_vehicle_from_bank(15.0, 0.65, &vehicle, NULL) || fga_settings_default(&settings)) {
    return "no vehicle or settings";
  }
  vehicle.bank_time_constant_s = 0.5;
  vehicle.turn_rate_factor = other_factor > 0.0 ? other_factor : 1.0;
  settings.margin_m = 5.0;
  if (fga_avoider_init(storage, sizeof storage, FGA_ABI_VERSION, 4, 2, &settings, &vehicle, &avoider, NULL) ||
      fga_avoider_set_mission(avoider, &mission, NULL)) {
    return "no avoider";
  }
  reference_loop loop;
  loop_begin(&loop, avoider, &vehicle);

  fga_ownship own = {.position_m = LEG[0].position_m, .airspeed_mps = 15.0};
  host_mode mode = HOST_MISSION;
  double least_m = INFINITY, taken_s = INFINITY, back_s = INFINITY;
  for (int cycle = 0; cycle < 700; ++cycle) {
    const double now_s = cycle * PERIOD_S;
    const bool faulty = fault != NO_FAULT && now_s >= FAULT_FROM_S && now_s < FAULT_UNTIL_S;
    fga_obstacle intruder = {
        .size = sizeof(fga_obstacle),
        .id = 1,
        .position_m = {900.0 - 20.0 * now_s, 4.0, 100.0},
        .velocity_mps = {-20.0, 0.0, 0.0},
        .volume = FGA_VOLUME_SPHERE,
        .movement = FGA_MOVEMENT_STRAIGHT,
        .radius_m = 30.0,
    };
    fga_situation situation = {
        .size = sizeof(fga_situation), .obstacle_count = 1, .obstacles = &intruder, .time_s = now_s, .ownship = own};
    if (faulty && fault == STATE_IS_NO_NUMBER) {
      situation.ownship.course_from_east_rad = (double)NAN;
    }
    if (faulty && fault == PILOT_TAKES_OVER) {
      mode = HOST_OTHER;
    } else if (fault == PILOT_TAKES_OVER && mode == HOST_OTHER) {
      mode = HOST_MISSION;
    }
    loop_set_point to = mission_set_point(&own);
    const bool is_fresh = !(faulty && fault == STATE_STOPS);
    const loop_action action = loop_tick(&loop, now_s, mode, is_fresh ? &situation : NULL, &own, &to);
    if (mode == HOST_OTHER && action != LOOP_NOTHING) {
      return "the loop acts while the pilot flies";
    }
    if (action == LOOP_TAKE) {
      mode = HOST_AVOID;
      taken_s = fmin(taken_s, now_s);
    } else if (action == LOOP_GIVE_BACK) {
      mode = HOST_MISSION;
      back_s = fmin(back_s, now_s);
    } else if (action == LOOP_NOTHING && mode == HOST_AVOID) {
      return "nobody flies";
    }
    fly(&own, to);
    least_m = fmin(least_m, hypot(intruder.position_m.east - own.position_m.east,
                                  hypot(4.0 - own.position_m.north, 100.0 - own.position_m.up)));
  }
  printf("%-24s taken %.1f s, given back %.1f s, least distance %.1f m, %u steps refused\n", FAULTS[fault], taken_s, back_s,
         least_m, (unsigned)loop.refused);
  if (taken_s > FAULT_FROM_S || mode != HOST_MISSION) {
    return "it does not begin in time, or the mission does not fly at the end";
  }
  if (fault == NO_FAULT) {
    return least_m < 30.0 ? "inside the volume" : loop.refused ? "a step is refused" : NULL;
  }
  if (fault == PILOT_TAKES_OVER) {
    return NULL;
  }
  if (back_s > FAULT_FROM_S + LOOP_STALE_S + PERIOD_S) {
    return "it is not given back in time";
  }
  return (fault == STATE_IS_NO_NUMBER) == (loop.refused > 0) ? NULL : "refused steps are miscounted";
}

int main(int count, char **arguments) {
  other_factor = count > 1 ? atof(arguments[1]) : 0.0;
  static const fault ALL[] = {NO_FAULT, PILOT_TAKES_OVER, STATE_STOPS, STATE_IS_NO_NUMBER};
  for (size_t k = 0; k < sizeof ALL / sizeof ALL[0]; ++k) {
    const char *wrong = flight(ALL[k]);
    if (wrong) {
      fprintf(stderr, "%s: %s\n", FAULTS[ALL[k]], wrong);
      return 1;
    }
  }
  return 0;
}
