// The task of fga_task.h as an autopilot calls it, in flights with a fault each. A plant flies: the program prints
// `fly BANK CLIMB ALTITUDE` each period, `new` before each flight, and reads the state; see tests/task.rs.

#include "fga_task.h"

#include <stdio.h>
#include <stdlib.h>

typedef enum {
  NO_FAULT,
  SHOWN_LATE,
  NOISY_REPORTS,
  ON_BELIEFS,
  ON_NOISY_BELIEFS,
  ON_BELIEFS_SILENT_BEFORE,
  ANOTHER_LEG,
  TRAFFIC_SILENT_BEFORE,
  TRAFFIC_SILENT_IN_THE_TURN,
  PILOT_CHOOSES,
  PILOT_CHOOSES_THE_MISSION,
  PILOT_MOVES_THE_STICKS,
  MODE_REFUSED,
  RETURN_REFUSED,
  STATE_STOPS,
  STATE_IS_NO_NUMBER,
  PLACE_JUMPS,
  TASK_STOPS,
  AVOID_IS_THE_PILOTS,
  FAULTS
} fault;

static const char *const NAMES[] = {"no fault",
                                    "shown 300 m ahead, a steep bank in need",
                                    "reports off by 20 m and 3 m/s",
                                    "on beliefs",
                                    "on beliefs, the least ADS-B",
                                    "on beliefs, traffic falls silent before",
                                    "another leg",
                                    "traffic falls silent before",
                                    "traffic falls silent in the turn",
                                    "the pilot chooses another mode",
                                    "the pilot chooses the mission",
                                    "the pilot moves the sticks",
                                    "the mode is refused",
                                    "the return is refused",
                                    "the state stops",
                                    "the state is no number",
                                    "the place jumps",
                                    "the task stops",
                                    "the pilot is in the mode of avoidance"};
static const double SPEED_MPS = 25.0, FAULT_FOR_S = 4.0;
static const fga_waypoint WAY[] = {{{0, 0, 100}, FGA_PASSING_FLY_BY},
                                   {{6000, 0, 100}, FGA_PASSING_FLY_BY},
                                   {{0, 200, 100}, FGA_PASSING_FLY_BY},
                                   {{6000, 200, 100}, FGA_PASSING_FLY_BY}};
static const fga_waypoint LEG[] = {{{0, 0, 100}, FGA_PASSING_FLY_BY}, {{4000, 0, 100}, FGA_PASSING_FLY_BY}};

static unsigned char storage[FGA_TASK_BYTES(4) + 1];
static union {
  unsigned char bytes[FGA_BELIEFS_BYTES];
  long double aligned;
} believed;

typedef struct {
  double least_m, off_m, asked_s, taken_s, back_s, back_beside_m, back_angle_rad;
  unsigned requests, pilot_requests;
  uint32_t alarms;
  double bank_rad, p_loss_hold, p_loss;  // and the largest chance of a loss on the mission, the least one as flown beside it
} seen;

// The state of the plant after a period.
static void fly(fga_ownship *own, double bank_left_rad, double climb_rad, double altitude_m) {
  printf("fly %.17g %.17g %.17g\n", bank_left_rad, climb_rad, altitude_m);
  fflush(stdout);
  fga_enu *at = &own->position_m;
  if (scanf("%lf %lf %lf %lf %lf %lf %lf", &at->east, &at->north, &at->up, &own->course_from_east_rad, &own->climb_rad,
            &own->bank_left_rad, &own->airspeed_mps) != 7) {
    exit(2);
  }
}

// How the autopilot flies its mission: towards the line of its leg.
static double mission_bank_rad(const fga_ownship *own, const fga_waypoint *way, uint32_t next, double *beside_m, double *angle_rad) {
  const fga_enu from = way[next - 1].position_m, to = way[next].position_m;
  const double leg_rad = atan2(to.north - from.north, to.east - from.east);
  const double left_m = cos(leg_rad) * (own->position_m.north - from.north) - sin(leg_rad) * (own->position_m.east - from.east);
  const double off_rad = remainder(own->course_from_east_rad - leg_rad, 2.0 * acos(-1.0));
  *beside_m = fabs(left_m);
  *angle_rad = fabs(off_rad);
  return fmax(-0.6, fmin(0.6, -1.2 * (off_rad + fmax(-0.8, fmin(0.8, 0.008 * left_m)))));
}

static fga_enu plus(fga_enu from, fga_enu rate, double times) {
  return (fga_enu){from.east + rate.east * times, from.north + rate.north * times, from.up + rate.up * times};
}

// Least distance while both fly straight from one period to the next.
static double nearest_m(fga_enu before, fga_enu after) {
  double least_m = INFINITY;
  for (int k = 0; k <= 10; ++k) {
    const fga_enu at = plus(before, plus(after, before, -1.0), k / 10.0);
    least_m = fmin(least_m, hypot(hypot(at.east, at.north), at.up));
  }
  return least_m;
}

// About a normal number: mean 0, standard deviation 1.
static double drawn(void) {
  static uint32_t state = 1;
  double sum = 0.0;
  for (int k = 0; k < 12; ++k) {
    state = state * 1664525u + 1013904223u;
    sum += state / 4294967296.0;
  }
  return sum - 6.0;
}

// Off by the standard deviations that it says.
static void make_noisy(fga_report *report) {
  double *const positions[] = {&report->position_m.east, &report->position_m.north, &report->position_m.up};
  double *const velocities[] = {&report->velocity_mps.east, &report->velocity_mps.north, &report->velocity_mps.up};
  const double lasting_m = report->lasting_altitude_sigma_m;  // one draw of it: above by as much
  for (int k = 0; k < 3; ++k) {
    const int is_up = k == 2 && report->altitude_sigma_m > 0.0;
    *positions[k] += (is_up ? report->altitude_sigma_m : report->position_sigma_m) * drawn();
    *velocities[k] += report->velocity_sigma_mps * drawn();
  }
  report->position_m.up += lasting_m;
}

// A flight on which an intruder on this track, degrees from east towards north, is at the same place at the same time.
static const char *flight(fault fault, double track_deg, double factor, double wind_north_mps) {
  const fga_waypoint *way = fault == ANOTHER_LEG ? WAY : LEG;
  const fga_mission mission = {.size = sizeof mission,
                               .waypoint_count = fault == ANOTHER_LEG ? 4 : 2,
                               .waypoints = way,
                               .floor_m = -INFINITY,
                               .ceiling_m = INFINITY};
  fga_task task;
  fga_task_settings settings;
  if (fga_task_settings_default(&settings, SPEED_MPS, 0.75, NULL)) return "no settings";
  settings.vehicle.turn_rate_factor = factor;
  if (fault == SHOWN_LATE && fga_task_settings_in_need(&settings, 1.1, NULL)) return "no limits in need";
  if (fault == ON_BELIEFS || fault == ON_NOISY_BELIEFS || fault == ON_BELIEFS_SILENT_BEFORE) {
    if (fga_beliefs_init(&believed, sizeof believed, FGA_ABI_VERSION, &settings.beliefs, NULL)) return "no beliefs";
  }
  // Storage is aligned by the task.
  if (fga_task_begin(&task, &settings, storage, 8, 4, NULL) != FGA_STATUS_STORAGE_TOO_SMALL ||
      fga_task_begin(&task, &settings, storage + 1, FGA_TASK_BYTES(4), 4, NULL) || fga_task_set_mission(&task, &mission, NULL)) {
    return "no task";
  }

  const double wind = fault == NO_FAULT ? wind_north_mps : 0.0;
  printf("new %.17g\n", wind);
  fga_ownship own = {.position_m = way[0].position_m, .airspeed_mps = SPEED_MPS};
  const double meets_s = fault == ANOTHER_LEG ? 100.0 : 50.0;
  const fga_enu meets_m = {25.0 * meets_s, fault == ANOTHER_LEG ? 200.0 : 0.0, 100.0};
  const double track_rad = track_deg * acos(-1.0) / 180.0;
  const fga_enu rate_mps = {30.0 * cos(track_rad), 30.0 * sin(track_rad), 0.0};
  const double silent_from_s = fault == TRAFFIC_SILENT_BEFORE || fault == ON_BELIEFS_SILENT_BEFORE ? meets_s - 20.0 : INFINITY;
  fga_task_mode mode = fault == AVOID_IS_THE_PILOTS ? FGA_TASK_MODE_AVOID : FGA_TASK_MODE_MISSION;
  uint32_t next = 1;
  seen seen = {.least_m = INFINITY, .asked_s = INFINITY, .taken_s = INFINITY, .back_s = INFINITY};
  double fault_from_s = INFINITY;
  fga_task_output out = {0};
  for (int cycle = 0; cycle < 1500; ++cycle) {
    const double now_s = cycle * FGA_TASK_PERIOD_S;
    // Most faults begin 2 s into the manoeuvre.
    if (now_s >= seen.taken_s + 2.0 || now_s >= silent_from_s) fault_from_s = fmin(fault_from_s, now_s);
    const int faulty = now_s >= fault_from_s && now_s < fault_from_s + FAULT_FOR_S;
    const int is_silent = (fault == TRAFFIC_SILENT_BEFORE || fault == ON_BELIEFS_SILENT_BEFORE || fault == TRAFFIC_SILENT_IN_THE_TURN) && now_s >= fault_from_s;
    const fga_enu other_m = plus(meets_m, rate_mps, now_s - meets_s);
    // A receiver reports once a second, half a second late.
    const fga_enu apart_m = plus(other_m, own.position_m, -1.0);
    const int is_shown = fault != SHOWN_LATE || hypot(apart_m.east, apart_m.north) < 300.0;
    if (cycle % 10 == 0 && is_shown && !is_silent) {
      fga_report report = {.size = sizeof report,
                                      .id = 7,
                                      .movement = FGA_MOVEMENT_CREWED,
                                      .has_velocity = 1,
                                      .time_s = now_s - 0.5,
                                      .position_m = plus(other_m, rate_mps, -0.5),
                                      .velocity_mps = rate_mps,
                                      .position_sigma_m = 3.0,
                                      .velocity_sigma_mps = 0.5};
      if (fault == NOISY_REPORTS) {
        report.position_sigma_m = 20.0;
        report.velocity_sigma_mps = 3.0;
      }
      if (fault == ON_NOISY_BELIEFS && fga_report_set_adsb(&report, 8, 1)) return "no errors";
      if (fault == NOISY_REPORTS || fault == ON_NOISY_BELIEFS) make_noisy(&report);
      fga_task_hear(&task, &report, now_s);
    }
    if (fault == PILOT_CHOOSES && faulty) mode = FGA_TASK_MODE_OTHER;
    if (fault == PILOT_CHOOSES && !faulty && mode == FGA_TASK_MODE_OTHER) mode = FGA_TASK_MODE_MISSION;
    // The operator sends the autopilot to the last leg.
    if (fault == ANOTHER_LEG && cycle == 200) next = 3;
    if (fault == PILOT_CHOOSES_THE_MISSION && now_s == fault_from_s) mode = FGA_TASK_MODE_MISSION;

    fga_task_input in = {.time_s = now_s,
                         .mode = mode,
                         .is_fresh = !(fault == STATE_STOPS && faulty),
                         .pilot_hand = fault == PILOT_MOVES_THE_STICKS && faulty,
                         .ownship = own,
                         .wind_mps = {0, wind, 0},
                         .next_waypoint = next};
    if (fault == STATE_IS_NO_NUMBER && faulty) in.ownship.course_from_east_rad = (double)NAN;
    if (fault == PLACE_JUMPS && faulty) in.ownship.position_m.north += 1500.0;
    fga_task_request request;
    if (fault == TASK_STOPS && faulty) {
      request = fga_task_watch(&task, now_s, mode);
    } else {
      fga_task_step(&task, &in, &out);
      request = out.request;
      if (fga_task_watch(&task, now_s, mode) != FGA_TASK_REQUEST_NONE) return "the watchdog acts beside a task that runs";
    }
    seen.alarms |= out.alarms;
    if ((task.decision.has & FGA_HAS_CHANCES) && task.decision.p_loss_hold > seen.p_loss_hold) {
      seen.p_loss_hold = task.decision.p_loss_hold;
      seen.p_loss = task.decision.p_loss;
    }
    if (request != FGA_TASK_REQUEST_NONE) {
      seen.requests += 1;
      seen.asked_s = fmin(seen.asked_s, now_s);
      if (mode == FGA_TASK_MODE_OTHER || fault == AVOID_IS_THE_PILOTS) return "it asks while the pilot flies";
      if (fault == PILOT_CHOOSES_THE_MISSION && now_s >= fault_from_s && now_s < fault_from_s + FGA_TASK_PAUSE_S) {
        return "it asks again at once";
      }
    }
    if (request == FGA_TASK_REQUEST_AVOID && fault != MODE_REFUSED) {
      mode = FGA_TASK_MODE_AVOID;
      seen.taken_s = fmin(seen.taken_s, now_s);
    }
    const int refuses = fault == RETURN_REFUSED && (isinf(seen.back_s) || now_s < seen.back_s + FAULT_FOR_S);
    double beside_m, angle_rad;
    const double bank_rad = mission_bank_rad(&own, way, next, &beside_m, &angle_rad);
    if (request == FGA_TASK_REQUEST_MISSION) {
      if (isinf(seen.back_s)) {
        seen.back_s = now_s;
        seen.back_beside_m = beside_m;
        seen.back_angle_rad = angle_rad;
      }
      if (!refuses) {
        mode = FGA_TASK_MODE_MISSION;
        next = out.next_waypoint;
      }
    }
    if (mode == FGA_TASK_MODE_AVOID && fault != AVOID_IS_THE_PILOTS && !(fault == TASK_STOPS && faulty) && !out.commands) {
      return "nobody flies";
    }
    if (mode == FGA_TASK_MODE_AVOID && fault != AVOID_IS_THE_PILOTS) {
      seen.off_m = fmax(seen.off_m, beside_m);
      seen.bank_rad = fmax(seen.bank_rad, fabs(out.bank_left_rad));
      fly(&own, out.bank_left_rad, out.climb_rad, out.altitude_m);
    } else {
      fly(&own, bank_rad, 0.0, 100.0);
    }
    const fga_enu before = plus(other_m, in.ownship.position_m, -1.0);
    seen.least_m = fmin(seen.least_m, nearest_m(before, plus(plus(other_m, rate_mps, FGA_TASK_PERIOD_S), own.position_m, -1.0)));
  }
  printf("%-38s %4.0f deg: taken %5.1f s, given back %5.1f s %3.0f m beside the leg, least distance %6.1f m, off %4.0f m, %s\n", NAMES[fault],
         track_deg, seen.taken_s, seen.back_s, seen.back_beside_m, seen.least_m, seen.off_m, fga_task_alarm_text(seen.alarms));
  const fga_task_counts *counts = &task.counts;
  fga_report_counts heard = {.size = sizeof heard};
  const fga_status counted =
      settings.beliefs ? fga_beliefs_counts(settings.beliefs, &heard) : fga_reports_counts(task.reports, &heard);
  if (counted || !heard.heard || heard.unusable || heard.late || heard.left_out) return "a report is lost";
  if (settings.beliefs && !(seen.p_loss_hold > 0.3 && seen.p_loss < 0.1 * seen.p_loss_hold)) return "no chance is said";
  switch (fault) {
    case AVOID_IS_THE_PILOTS:
      return seen.requests || counts->maneuvers ? "it acts in the pilot's mode" : NULL;
    case MODE_REFUSED:
      return counts->refusals < 2 || counts->maneuvers || !(seen.alarms & FGA_TASK_ALARM_REFUSED) ? "a refusal is not told" : NULL;
    case PILOT_CHOOSES:
    case PILOT_CHOOSES_THE_MISSION:
      return counts->pilot_wins != 1 ? "the pilot is miscounted" : NULL;
    case PILOT_MOVES_THE_STICKS:
      return seen.back_s > fault_from_s || counts->pilot_wins != 1 ? "the pilot's hand is not heeded" : NULL;
    case STATE_STOPS:
    case STATE_IS_NO_NUMBER:
    case PLACE_JUMPS:
      if (!(seen.alarms & FGA_TASK_ALARM_NO_STATE)) return "the silence is not told";
      // A place that jumps is believed after 3 s, and so is the one to which it jumps back.
      const uint32_t lost = fault == STATE_STOPS ? counts->steps_without_state : counts->steps_refused;
      if (lost != (fault == PLACE_JUMPS ? 58 : 40)) return "steps are miscounted";
      return seen.back_s > fault_from_s + FGA_TASK_STALE_S + FGA_TASK_PERIOD_S ? "it is not given back in time" : NULL;
    case TASK_STOPS:
      if (counts->stops != 1 || counts->pilot_wins) return "the stop is miscounted";
      return seen.back_s > fault_from_s + FGA_TASK_STALE_S + 2.0 * FGA_TASK_PERIOD_S ? "it is not given back in time" : NULL;
    case SHOWN_LATE:
      if (seen.bank_rad < 0.9) return "no steeper bank in need";
      break;
    case NOISY_REPORTS:
      // Without the filter 549 m.
      if (seen.off_m > 250.0) return "too far from the leg";
      break;
    default:
      if (seen.bank_rad > 0.76) return "a steeper bank without need";
      break;
  }
  if (seen.least_m < 60.0) return "inside the volume";
  if (counts->maneuvers != 1 || mode != FGA_TASK_MODE_MISSION) return "one change of mode out and one back are expected";
  if (seen.back_beside_m > FGA_TASK_ON_LEG_M || (wind == 0.0 && seen.back_angle_rad > FGA_TASK_ON_LEG_RAD)) {
    return "not given back on the leg";
  }
  return fault == RETURN_REFUSED && !(seen.alarms & FGA_TASK_ALARM_NOT_RETURNED) ? "the refused return is not told" : NULL;
}

// A task on the leg, without traffic.
static int begin(fga_task *task) {
  static const fga_mission mission = {sizeof mission, 2, LEG, -100.0, 1e4};
  fga_task_settings settings;
  return fga_task_settings_default(&settings, SPEED_MPS, 0.75, NULL) ||
         fga_task_begin(task, &settings, storage, sizeof storage, 4, NULL) || fga_task_set_mission(task, &mission, NULL);
}

static int is_on_leg(double north_m, double course_rad, double up_m, double climb_max_rad) {
  fga_task task;
  if (begin(&task)) return -1;
  task.settings.vehicle.climb_max_rad = climb_max_rad;
  task.ownship = (fga_ownship){.position_m = {500, north_m, up_m}, .course_from_east_rad = course_rad, .airspeed_mps = SPEED_MPS};
  return fga_task_is_on_leg(&task, (fga_enu){0, 0, 0});
}

static const char *on_the_leg(void) {
  const int on = is_on_leg(17, 0, 100, 0.1) && is_on_leg(-17, 0, 100, 0.1) && is_on_leg(0, 0.05, 100, 0.1) &&
                 is_on_leg(0, 0, 111, 0.1) && is_on_leg(0, 0, 150, 0.0);
  const int off = is_on_leg(19, 0, 100, 0.1) || is_on_leg(-19, 0, 100, 0.1) || is_on_leg(0, -0.07, 100, 0.1) ||
                  is_on_leg(0, 3.1, 100, 0.1) || is_on_leg(0, 0, 113, 0.1);
  return on && !off ? NULL : "on the leg is something else";
}

static uint32_t obstacles_at(fga_task *task, double now_s) {
  uint32_t count = 0;
  return fga_reports_obstacles(task->reports, now_s, 60, 0, task->obstacles, FGA_TASK_TRAFFIC_MOST, &count, NULL) ? 99 : count;
}

static const char *reports_are_counted(void) {
  fga_task task;
  fga_report report = {.size = sizeof report,
                       .movement = FGA_MOVEMENT_CREWED,
                       .has_velocity = 1,
                       .time_s = 100.0,
                       .velocity_mps = {10, 0, 0}};
  fga_report_counts counts = {.size = sizeof counts};
  if (begin(&task)) return "no task";
  for (uint32_t k = 0; k < FGA_TASK_TRAFFIC_MOST + 2; ++k) {
    report.id = k;
    report.position_m.east = 100.0 * (FGA_TASK_TRAFFIC_MOST + 1 - k);  // each nearer than the one before
    fga_task_hear(&task, &report, 101.0);
  }
  if (obstacles_at(&task, 102.0) != FGA_TASK_TRAFFIC_MOST || !task.incomplete) return "room is miscounted";
  for (uint32_t k = 0; k < FGA_TASK_TRAFFIC_MOST; ++k) {
    if (task.obstacles[k].id < 2) return "the farthest ones stay";
    const double reported_m = 100.0 * (FGA_TASK_TRAFFIC_MOST + 1 - task.obstacles[k].id);
    if (fabs(task.obstacles[k].position_m.east - reported_m - 20.0) > 0.1 || task.obstacles[k].age_s != 2.0) return "not carried on";
  }
  report.time_s = 99.0;
  fga_task_hear(&task, &report, 101.0);
  report.time_s = 103.0;
  fga_task_hear(&task, &report, 101.0);
  report.time_s = 100.5;
  report.velocity_mps.up = (double)NAN;
  fga_task_hear(&task, &report, 101.0);
  report.velocity_mps.up = 0.0;
  report.movement = 0;
  fga_task_hear(&task, &report, 101.0);
  if (fga_reports_counts(task.reports, &counts) || counts.heard != FGA_TASK_TRAFFIC_MOST + 6 || counts.left_out != 2 ||
      counts.late != 1 || counts.unusable != 3) {
    return "reports are miscounted";
  }
  // A mast stays, an aircraft that is heard no more goes.
  report.movement = FGA_MOVEMENT_AT_REST;
  fga_task_hear(&task, &report, 101.0);
  if (obstacles_at(&task, 119.9) != FGA_TASK_TRAFFIC_MOST) return "forgotten too early";
  return obstacles_at(&task, 120.1) == 1 ? NULL : "not forgotten";
}

static const char *a_turn_rolls_out(void) {
  fga_task task;
  fga_task_output out = {0};
  if (begin(&task)) return "no task";
  task.decided_s = 0.0;
  task.decision.stage_count = 1;
  task.decision.stages[0] = (fga_stage){0.0, 1.0, 0.0, 1.0};
  fga_ownship own = {.position_m = {0, 0, 120}, .airspeed_mps = SPEED_MPS};
  fga_task_set_point(&task, &own, 0.1, &out);
  if (fabs(out.bank_left_rad - 0.75) > 1e-6 || out.course_from_east_rad != 1.0 || out.altitude_m != 120.0) {
    return "it does not turn with the largest bank";
  }
  // Nearly there but still banked: the other way.
  own.course_from_east_rad = 0.98;
  own.bank_left_rad = 0.75;
  fga_task_set_point(&task, &own, 0.2, &out);
  if (out.bank_left_rad >= 0.0) return "it does not roll out";
  fga_task_set_point(&task, &own, 0.4, &out);
  return out.bank_left_rad == 0.0 ? NULL : "it flies a stale command";
}

// What the task plans a second after it was begun or restarted, 12 s before a mast on the leg.
static const fga_decision *plans(fga_task *task, double now_s) {
  const fga_enu at = LEG[0].position_m;
  const fga_report mast = {.size = sizeof mast, .id = 9, .time_s = now_s, .movement = FGA_MOVEMENT_AT_REST,
                           .position_m = {at.east + 12.0 * SPEED_MPS, at.north, at.up}};
  fga_task_input in = {.mode = FGA_TASK_MODE_MISSION, .is_fresh = 1, .ownship = {.position_m = at, .airspeed_mps = SPEED_MPS}};
  fga_task_output out;
  fga_task_hear(task, &mast, now_s);
  in.time_s = now_s;
  fga_task_step(task, &in, &out);
  return &task->decision;
}

// A task whose limits say a turn-rate factor of `factor` / 0.8 learns it in a minute of turns that somebody else commands,
// but not their lag, and forgets nothing in a restart. The limits in need keep their share of the others. A hand on the sticks
// turns in the mode of avoidance while the return is refused.
static const char *learns(double factor, fga_task_mode mode, uint32_t pilot_hand) {
  static unsigned char evidence[FGA_LEARNED_BYTES + FGA_ALIGN];
  unsigned char *const aligned = evidence + (FGA_ALIGN - (uintptr_t)evidence % FGA_ALIGN) % FGA_ALIGN;
  static const fga_mission mission = {sizeof mission, 2, LEG, -100.0, 1e4};
  fga_task task;
  fga_task_settings settings;
  if (fga_task_settings_default(&settings, SPEED_MPS, 0.75, NULL)) return "no settings";
  settings.vehicle.turn_rate_factor = factor / 0.8;
  if (fga_task_settings_in_need(&settings, 1.1, NULL)) return "no limits in need";
  if (fga_learned_init(aligned, FGA_LEARNED_BYTES, FGA_ABI_VERSION, &settings.vehicle, &settings.learned, NULL) ||
      fga_task_begin(&task, &settings, storage, sizeof storage, 4, NULL) || fga_task_set_mission(&task, &mission, NULL)) {
    return "no task";
  }
  printf("new 0\n");
  fga_task_input in = {.mode = mode, .is_fresh = 1, .ownship = {.position_m = LEG[0].position_m, .airspeed_mps = SPEED_MPS}};
  fga_task_output out;
  in.pilot_hand = pilot_hand;
  if (pilot_hand) task.phase = FGA_TASK_RETURNS;
  for (int cycle = 0; cycle < 600; ++cycle) {
    if (cycle == 595 && pilot_hand) in.mode = FGA_TASK_MODE_MISSION;  // it plans with what was learned
    in.time_s = cycle * FGA_TASK_PERIOD_S;
    fga_task_step(&task, &in, &out);
    fly(&in.ownship, cycle / 40 % 2 ? 0.6 : -0.6, 0.0, 100.0);
  }
  const double learned = task.settings.vehicle.turn_rate_factor;
  printf("%-38s the factor %.3f for %.3f, by the settings %.3f\n", "learns", learned, factor, factor / 0.8);
  if (fabs(task.settings.vehicle.bank_time_constant_s - 0.5) > 1e-9) return "it learns a lag without commands";
  if (task.settings.vehicle.dead_time_s != 0.0 || fabs(learned - 0.97 * factor) > 0.07 * factor) return "it learns something else";
  if (fabs(task.settings.in_need.turn_rate_factor - 0.95 * learned) > 1e-9) return "the limits in need do not learn";
  fga_task_restart(&task);
  if (task.settings.vehicle.turn_rate_factor != learned) return "a restart forgets what was learned";
  // It plans then as a task that is begun with what was learned.
  static unsigned char again[sizeof storage];
  fga_task other;
  settings.vehicle = task.settings.vehicle;
  settings.learned = NULL;
  if (fga_task_begin(&other, &settings, again, sizeof again, 4, NULL) || fga_task_set_mission(&other, &mission, NULL)) return "no task";
  const fga_decision *const after = plans(&task, 100.0), *const begun = plans(&other, 100.0);
  return memcmp(after->stages, begun->stages, sizeof after->stages) ? "a restart plans without what was learned" : NULL;
}

int main(int count, char **arguments) {
  const double factor = count > 1 ? atof(arguments[1]) : 1.0, wind_mps = count > 2 ? atof(arguments[2]) : 0.0;
  int wrong = 0;
  const char *const units[] = {on_the_leg(), reports_are_counted(), a_turn_rolls_out(), learns(factor, FGA_TASK_MODE_MISSION, 0),
                               learns(factor, FGA_TASK_MODE_AVOID, 0), learns(factor, FGA_TASK_MODE_AVOID, 1)};
  for (size_t k = 0; k < sizeof units / sizeof units[0]; ++k) {
    if (units[k]) {
      fprintf(stderr, "%s\n", units[k]);
      wrong = 1;
    }
  }
  for (int k = 0; k < 12 + FAULTS - 1; ++k) {
    const fault fault_or_none = k < 12 ? NO_FAULT : (fault)(k - 11);
    const double track_deg = k < 12 ? 30.0 * k : fault_or_none == SHOWN_LATE ? 210.0 : 180.0;
    const char *why = flight(fault_or_none, track_deg, factor, wind_mps);
    if (why) {
      fprintf(stderr, "%s, %.0f deg: %s\n", NAMES[fault_or_none], track_deg, why);
      wrong = 1;
    }
  }
  return wrong;
}
