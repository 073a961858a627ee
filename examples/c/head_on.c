// A head-on encounter, decided by fga and flown here: the C program that corresponds to `fga run`.
//
//   head_on          flies the encounter and prints every decision that differs from the one before
//   head_on FILE     decides along recorded states instead, one line a decision: time, the aircraft (east, north, up, course,
//                    climb, bank, airspeed) and the intruder (east, north, up); prints every decision, exactly
//
// cc -std=c11 head_on.c -I PREFIX/include -L PREFIX/lib -lfga_c -lm

#include "fga.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double PERIOD_S = 0.1;

// One leg to the east at 100 m, and an intruder on it from the other end.
static const fga_waypoint LEG[] = {
    {.position_m = {0.0, 0.0, 100.0}, .passing = FGA_PASSING_FLY_BY},
    {.position_m = {1200.0, 0.0, 100.0}, .passing = FGA_PASSING_FLY_BY},
};
static const fga_enu INTRUDER_M = {900.0, 4.0, 102.0};
static const fga_enu INTRUDER_MPS = {-20.0, 0.0, 0.0};

// Storage for 4 obstacles and 2 waypoints; and for the prover, which flies the aircraft here.
static _Alignas(FGA_ALIGN) unsigned char avoider_storage[FGA_AVOIDER_BYTES(4, 2)];
static _Alignas(FGA_ALIGN) unsigned char prover_storage[FGA_PROVER_BYTES];

static fga_refusal why = {.size = sizeof(fga_refusal)};

// Says what was refused; 1 if it was.
static int refused(const char *call, fga_status status) {
  if (status == FGA_STATUS_OK || status == FGA_STATUS_INCOMPLETE) {
    return 0;
  }
  fprintf(stderr, "%s: %s", call, fga_status_text(status));
  if (status >= FGA_STATUS_OUT_OF_RANGE) {
    fprintf(stderr, ": %s is %g, expected %s", why.field, why.value, why.expected);
  }
  fprintf(stderr, "\n");
  return 1;
}

static fga_obstacle intruder_at(fga_enu position_m) {
  fga_obstacle intruder = {
      .size = sizeof(fga_obstacle),
      .id = 1,
      .position_m = position_m,
      .velocity_mps = INTRUDER_MPS,
      .volume = FGA_VOLUME_SPHERE,
      .movement = FGA_MOVEMENT_STRAIGHT,
      .radius_m = 30.0,
  };
  return intruder;
}

// Seventeen digits say a double exactly.
static void print_exactly(const fga_decision *decision) {
  printf("%u %u %u", (unsigned)decision->state, (unsigned)decision->reason, (unsigned)decision->has);
  for (uint32_t k = 0; k < decision->stage_count; ++k) {
    const fga_stage *stage = &decision->stages[k];
    printf(" %.17g %.17g %.17g %.17g", stage->start_s, stage->course_from_east_rad, stage->climb_rad, stage->rate_share);
  }
  printf(" %.17g %.17g %.17g\n", decision->margin_m, decision->certified_margin_m, decision->start_s);
}

static void print_change(double time_s, const fga_decision *decision) {
  static uint32_t last_state = UINT32_MAX, last_reason = UINT32_MAX;
  if (decision->state == last_state && decision->reason == last_reason) {
    return;
  }
  last_state = decision->state;
  last_reason = decision->reason;
  printf("%5.1f s  %-10s  %s", time_s, fga_state_text(decision->state), fga_reason_text(decision->reason));
  if (decision->has & FGA_HAS_CERTIFICATE) {
    printf("; keeps %.2f m for %.0f s", decision->certified_margin_m, decision->certified_horizon_s);
  }
  printf("\n");
}

int main(int argc, char **argv) {
  fga_vehicle vehicle = {.size = sizeof(fga_vehicle)};
  fga_settings settings = {.size = sizeof(fga_settings)};
  if (refused("fga_settings_default", fga_settings_default(&settings))) {
    return 1;
  }
  // 15 m/s, turns of 30 m radius, climbs of up to 15 degrees: the aircraft of vehicles/paper.toml.
  vehicle.airspeed_mps = 15.0;
  vehicle.turn_radius_m = 30.0;
  vehicle.climb_max_rad = 15.0 * (3.14159265358979323846 / 180.0);
  vehicle.climb_min_rad = -vehicle.climb_max_rad;
  vehicle.climb_rate_radps = 0.2;
  vehicle.turn_rate_factor = 1.0;
  settings.surveillance_radius_m = 300.0;
  settings.decision_period_s = PERIOD_S;

  fga_avoider *avoider = NULL;
  fga_prover *prover = NULL;
  fga_mission mission = {
      .size = sizeof(fga_mission),
      .waypoint_count = 2,
      .waypoints = LEG,
      .floor_m = 70.0,  // 30 m below the waypoints, as in a scenario without a floor of its own
      .ceiling_m = INFINITY,
  };
  if (refused("fga_avoider_init", fga_avoider_init(avoider_storage, sizeof avoider_storage, FGA_ABI_VERSION, 4, 2,
                                                   &settings, &vehicle, &avoider, &why)) ||
      refused("fga_avoider_set_mission", fga_avoider_set_mission(avoider, &mission, &why)) ||
      refused("fga_prover_init", fga_prover_init(prover_storage, sizeof prover_storage, FGA_ABI_VERSION, &vehicle,
                                                 &prover, &why))) {
    return 1;
  }

  FILE *states = NULL;
  if (argc > 1 && (states = fopen(argv[1], "r")) == NULL) {
    fprintf(stderr, "%s: no such file\n", argv[1]);
    return 1;
  }
  fga_ownship own = {.position_m = LEG[0].position_m, .airspeed_mps = 15.0};
  double least_m = INFINITY;
  for (int cycle = 0; states || cycle < 900; ++cycle) {
    double time_s = cycle * PERIOD_S;
    fga_enu place_m = {INTRUDER_M.east + INTRUDER_MPS.east * time_s, INTRUDER_M.north, INTRUDER_M.up};
    if (states && fscanf(states, "%lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf", &time_s, &own.position_m.east,
                         &own.position_m.north, &own.position_m.up, &own.course_from_east_rad, &own.climb_rad,
                         &own.bank_left_rad, &own.airspeed_mps, &place_m.east, &place_m.north, &place_m.up) != 11) {
      break;
    }
    fga_obstacle intruder = intruder_at(place_m);
    fga_situation situation = {
        .size = sizeof(fga_situation),
        .obstacle_count = 1,
        .obstacles = &intruder,
        .time_s = time_s,
        .ownship = own,
    };
    fga_decision decision = {.size = sizeof(fga_decision)};
    if (refused("fga_avoider_step", fga_avoider_step(avoider, &situation, &decision, &why))) {
      return 1;
    }
    if (states) {
      print_exactly(&decision);
      continue;
    }
    print_change(time_s, &decision);
    fga_enu still_air = {0.0, 0.0, 0.0};
    fga_ownship then = own;
    if (refused("fga_predict", fga_predict(prover, &own, decision.stages, decision.stage_count, still_air, PERIOD_S,
                                           &then, &why))) {
      return 1;
    }
    own = then;
    double apart_m = hypot(hypot(place_m.east - own.position_m.east, place_m.north - own.position_m.north),
                           place_m.up - own.position_m.up);
    least_m = apart_m < least_m ? apart_m : least_m;
  }
  if (states) {
    fclose(states);
    return 0;
  }
  printf("least distance %.1f m, volume of 30 m\n", least_m);
  return least_m < 30.0;
}
