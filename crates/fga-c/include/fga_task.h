// fga_task: collision avoidance as one task of an autopilot, called ten times a second. Header only, for C99 and C++11; it
// allocates nothing. Frame and units are those of fga.h: east, north, up; courses from east towards north; left is positive.
//
//   mission flies ---a manoeuvre begins: FGA_TASK_REQUEST_AVOID---> fga flies ---on the leg, or no input--->
//                                                  FGA_TASK_REQUEST_MISSION ---> mission flies
//
// The autopilot owns its modes and has the last word. Each period it
//   1. gives the task each report of traffic, as it comes: fga_task_hear;
//   2. calls fga_task_step with the state of this moment, the mode and the pilot's hand;
//   3. makes the mode request, and flies the set-point while `commands` is 1.
// A second, independent place of the autopilot calls fga_task_watch: it asks for the mission when the task stops.
//
// THE PILOT WINS. A mode that the task did not ask for ends what it does, at once and without a request. A hand on the sticks
// gives the mode back. After either the task asks for nothing for FGA_TASK_PAUSE_S.
//
// TRAFFIC. Reports may be raw: the task filters them (fga_reports of fga.h), carries each aircraft on by the age of its last report, and
// lets it go after `traffic_lifetime_s`. With `beliefs` it decides by expected cost on what they say, see there. Do not give it the reports
// of the aircraft itself.
//
// THREADS. One call at a time on one task: where the watchdog runs in another thread, the autopilot locks.

#ifndef FGA_TASK_H
#define FGA_TASK_H

#include "fga.h"

#include <math.h>
#include <string.h>

// Most aircraft and masts that a task knows at once. A program may define another number before it includes this header.
#ifndef FGA_TASK_TRAFFIC_MOST
#define FGA_TASK_TRAFFIC_MOST 16
#endif

// Bytes of storage for a task whose mission has up to this many waypoints. The storage needs no alignment.
#define FGA_TASK_BYTES(waypoints) \
  (FGA_REPORTS_BYTES(FGA_TASK_TRAFFIC_MOST) + FGA_AVOIDER_BYTES(FGA_TASK_TRAFFIC_MOST, waypoints) + FGA_ALIGN)

// Period of the task, seconds.
#define FGA_TASK_PERIOD_S 0.1
// A decision is flown on for this long without a newer one, seconds; then the mode is given back.
#define FGA_TASK_STALE_S 0.35
// A place is refused that is farther from the last one than this and this speed lead, metres and metres per second, ...
#define FGA_TASK_JUMP_M 200.0
#define FGA_TASK_JUMP_MPS 150.0
// ... for this time, seconds.
#define FGA_TASK_JUMP_S 3.0
// The mode is asked for when a manoeuvre begins within this time, seconds.
#define FGA_TASK_PREPARE_S 0.6
// A mode that is not taken up within this time counts as refused, seconds.
#define FGA_TASK_REFUSED_S 1.0
// After a refusal, the pilot's hand or the pilot's choice the task asks for nothing for this long, seconds.
#define FGA_TASK_PAUSE_S 5.0
// The aircraft is on its leg within this distance beside it, metres,
#define FGA_TASK_ON_LEG_M 18.0
// ... this distance above or below it where it may climb, metres,
#define FGA_TASK_ON_LEG_HEIGHT_M 12.0
// ... and this angle of its course over the ground, radians. The mode is given back ...
#define FGA_TASK_ON_LEG_RAD 0.06
// ... after this long on the leg, seconds,
#define FGA_TASK_ON_LEG_FOR_S 0.4
// ... or without a threat after this long beside it, seconds.
#define FGA_TASK_LONGEST_WAY_BACK_S 120.0
// The task takes the autopilot's leg for its own after this long on another one, seconds.
#define FGA_TASK_OTHER_LEG_S 3.0
// A turn rolls out over at least this time, seconds. At ten set-points a second ArduPlane rocks by 15 degrees where it is 0.6.
#define FGA_TASK_SHORTEST_ROLL_OUT_S 1.0

// Who flies, as the autopilot's mode says it.
typedef enum {
  FGA_TASK_MODE_OTHER = 0,    // every mode that is neither of the two: the pilot's, a failsafe's
  FGA_TASK_MODE_MISSION = 1,  // a mode from which the task may take over, and to which it gives back
  FGA_TASK_MODE_AVOID = 2     // the mode in which the autopilot flies the set-points
} fga_task_mode;

typedef enum {
  FGA_TASK_REQUEST_NONE = 0,
  FGA_TASK_REQUEST_AVOID = 1,   // change from the mission to the mode of avoidance
  FGA_TASK_REQUEST_MISSION = 2  // change from the mode of avoidance to the mission
} fga_task_request;

// What the pilot must know, as bits of `alarms`; fga_task_alarm_text has a sentence for each.
typedef enum {
  FGA_TASK_ALARM_NO_STATE = 1,       // the mode was given back or is not taken: no usable state
  FGA_TASK_ALARM_REFUSED = 2,        // the mode of avoidance was refused
  FGA_TASK_ALARM_NOT_RETURNED = 4,   // the mission's mode was refused: set it
  FGA_TASK_ALARM_NOT_CERTIFIED = 8,  // what is flown is the best that there is, not certified
  FGA_TASK_ALARM_INCOMPLETE = 16     // traffic is left out: no room, or unusable numbers
} fga_task_alarm;

// Settings of a task. fga_task_settings_default fills it; then adapt it.
typedef struct fga_task_settings {
  // Limits of the aircraft as flown, see fga.h.
  fga_vehicle vehicle;
  // Limits where nothing is certified with those, such as a steeper bank; `size` 0 for none.
  fga_vehicle in_need;
  // Settings of the decisions, see fga.h.
  fga_settings decisions;
  // Radius of the volume around each aircraft, metres.
  double radius_m;
  // Half height of the volume, metres; 0 for a sphere.
  double half_height_m;
  // An aircraft that is heard no more is forgotten after this time, seconds. What is at rest is not.
  double traffic_lifetime_s;
  // A learner of `vehicle`, see fga_learned_init; null for none. The task shows it each fresh state but in the pilot's modes, and plans
  // with what was learned from the next manoeuvre on.
  fga_learned *learned;
  // Beliefs, see fga_beliefs_init; null for none. With them the task decides by expected cost among aircraft, whose reports they hear too.
  fga_beliefs *beliefs;
} fga_task_settings;

// The state of one period.
typedef struct fga_task_input {
  // Time, seconds, on a clock that does not run backwards.
  double time_s;
  // The mode that the autopilot is in now.
  fga_task_mode mode;
  // Whether `ownship` and `wind_mps` are of this moment and good (1), or not (0).
  uint32_t is_fresh;
  // Whether the pilot moves the sticks (1), or not (0).
  uint32_t pilot_hand;
  // The state of the aircraft in the air mass.
  fga_ownship ownship;
  // Velocity of the air over the ground, metres per second.
  fga_enu wind_mps;
  // Index of the waypoint that the mission flies to; 0 where it is not known. Where it stays another one than the task's for
  // FGA_TASK_OTHER_LEG_S, the task goes on with that leg.
  uint32_t next_waypoint;
  // Zones, and the ground or null, as in fga_situation.
  const fga_zone *zones;
  uint32_t zone_count;
  const fga_ground *ground;
} fga_task_input;

// What the autopilot is to do in this period.
typedef struct fga_task_output {
  // The mode to ask for. It is repeated each period until the autopilot is in it or the task gives up.
  fga_task_request request;
  // Whether the set-point is to be flown in the mode of avoidance (1), or not (0).
  uint32_t commands;
  // Course through the air, radians from east towards north.
  double course_from_east_rad;
  // Bank, radians, positive to the left: the one that flies this course as predicted. Prefer it to the course.
  double bank_left_rad;
  // Climb angle, radians.
  double climb_rad;
  // Where the climb angle is 0: the altitude to hold, metres up.
  double altitude_m;
  // Index of the waypoint to go on with when the mission flies.
  uint32_t next_waypoint;
  // What the pilot must know, bits FGA_TASK_ALARM_...
  uint32_t alarms;
} fga_task_output;

// What a task has done; fga_reports_counts(task->reports, ...), or fga_beliefs_counts, has what became of reports. The counts never fall.
typedef struct fga_task_counts {
  uint32_t maneuvers;           // manoeuvres that the autopilot let the task fly
  uint32_t refusals;            // requests for the mode of avoidance that were not followed in time
  uint32_t pilot_wins;          // manoeuvres that the pilot or the autopilot ended
  uint32_t stops;               // times that the task was not called for longer than FGA_TASK_STALE_S
  uint32_t steps_refused;       // steps that fga refused; `why` has the last reason
  uint32_t steps_without_state; // steps without a fresh state
} fga_task_counts;

typedef enum { FGA_TASK_WATCHES, FGA_TASK_ASKS, FGA_TASK_FLIES, FGA_TASK_RETURNS } fga_task_phase;

// A task. Its fields are for logs; the functions below change them.
typedef struct fga_task {
  fga_avoider *avoider;
  fga_reports *reports;
  fga_task_settings settings;
  fga_mission mission;
  uint32_t first_waypoint;  // the avoider's mission begins at this waypoint
  double other_leg_since_s; // since when the autopilot flies another leg; INFINITY where it does not
  fga_task_phase phase;
  fga_decision decision;    // the last one
  fga_ownship ownship;      // the state of it
  double decided_s;         // its time; -INFINITY without one
  double step_s;            // time of the last step
  double since_s;           // time of the phase's begin
  double pause_until_s;     // no request before this time
  double on_leg_since_s;    // since when it is on its leg; INFINITY where it is not
  double beside_since_s;    // since when nothing threatens
  double held_m;            // the altitude to hold; NAN where none is held
  uint32_t alarms;
  uint32_t incomplete;      // whether a report had no room since the last step
  fga_obstacle obstacles[FGA_TASK_TRAFFIC_MOST];  // those of the last step; here to spare the stack
  fga_refusal why;          // the last refusal
  fga_task_counts counts;
} fga_task;

// A sentence for the lowest alarm of these bits; "" for none.
static inline const char *fga_task_alarm_text(uint32_t alarms) {
  if (alarms & FGA_TASK_ALARM_NOT_RETURNED) return "fga: mission mode refused, set a mode";
  if (alarms & FGA_TASK_ALARM_NO_STATE) return "fga: no usable state, gave back";
  if (alarms & FGA_TASK_ALARM_REFUSED) return "fga: mode refused, not avoiding";
  if (alarms & FGA_TASK_ALARM_NOT_CERTIFIED) return "fga: avoiding, not certified";
  if (alarms & FGA_TASK_ALARM_INCOMPLETE) return "fga: traffic left out";
  return "";
}

// Fills settings for an aircraft of this airspeed, metres per second, and largest bank, radians: a sphere of 60 m around what is
// reported, a margin of 5 m, a bank lag of 0.5 s, level flight. Refuses what fga_vehicle_from_bank refuses.
static inline fga_status fga_task_settings_default(fga_task_settings *settings, double airspeed_mps, double bank_max_rad,
                                                   fga_refusal *why) {
  memset(settings, 0, sizeof *settings);
  settings->vehicle.size = sizeof(fga_vehicle);
  settings->decisions.size = sizeof(fga_settings);
  fga_status status = fga_vehicle_from_bank(airspeed_mps, bank_max_rad, &settings->vehicle, why);
  if (status == FGA_STATUS_OK) status = fga_settings_default(&settings->decisions);
  settings->vehicle.bank_time_constant_s = 0.5;
  settings->decisions.margin_m = 5.0;
  settings->radius_m = 60.0;
  settings->traffic_lifetime_s = 20.0;
  return status;
}

// Lets the aircraft of the settings bank up to `bank_rad`, radians, where nothing is certified with its usual bank. It rolls there for longer, so
// it turns by a little less than the ideal rate. Refuses what fga_vehicle_from_bank refuses.
static inline fga_status fga_task_settings_in_need(fga_task_settings *settings, double bank_rad, fga_refusal *why) {
  fga_vehicle *const need = &settings->in_need;
  need->size = sizeof(fga_vehicle);
  const fga_status status = fga_vehicle_from_bank(settings->vehicle.airspeed_mps, bank_rad, need, why);
  need->turn_rate_factor = 0.95 * settings->vehicle.turn_rate_factor;
  need->bank_time_constant_s = settings->vehicle.bank_time_constant_s;
  return status;
}

// Forgets the flight, not the traffic: the next step is the first of another one.
static inline void fga_task_restart(fga_task *task) {
  (void)fga_avoider_restart(task->avoider);
  if (task->settings.beliefs) (void)fga_beliefs_restart(task->settings.beliefs);
  if (task->settings.learned) (void)fga_avoider_set_vehicle(task->avoider, &task->settings.vehicle, &task->why);
  if (task->settings.in_need.size) (void)fga_avoider_set_vehicle_in_need(task->avoider, &task->settings.in_need, &task->why);
  task->decided_s = -INFINITY;
  task->decision.state = FGA_STATE_CRUISE;
  task->decision.stage_count = 0;
}

// Begins a task in storage of the caller, FGA_TASK_BYTES of it, without a mission. Task and storage must not be moved.
// Refuses what fga_reports_init and fga_avoider_init refuse.
static inline fga_status fga_task_begin(fga_task *task, const fga_task_settings *settings, void *storage, size_t storage_bytes,
                                        uint32_t waypoints_most, fga_refusal *why) {
  memset(task, 0, sizeof *task);
  task->settings = *settings;
  task->decision.size = sizeof(fga_decision);
  task->why.size = sizeof(fga_refusal);
  task->step_s = -INFINITY;
  task->pause_until_s = -INFINITY;
  task->on_leg_since_s = task->beside_since_s = task->other_leg_since_s = INFINITY;
  task->held_m = (double)NAN;
  const size_t before = (FGA_ALIGN - (size_t)((uintptr_t)storage % FGA_ALIGN)) % FGA_ALIGN;
  const size_t filter = FGA_REPORTS_BYTES(FGA_TASK_TRAFFIC_MOST);
  if (storage_bytes < before + filter) return FGA_STATUS_STORAGE_TOO_SMALL;
  unsigned char *const at = (unsigned char *)storage + before;
  fga_status status = fga_reports_init(at, filter, FGA_ABI_VERSION, FGA_TASK_TRAFFIC_MOST, settings->traffic_lifetime_s,
                                       &task->reports, why);
  if (status == FGA_STATUS_OK) {
    status = fga_avoider_init(at + filter, storage_bytes - before - filter, FGA_ABI_VERSION, FGA_TASK_TRAFFIC_MOST, waypoints_most,
                              &settings->decisions, &settings->vehicle, &task->avoider, why);
  }
  if (status == FGA_STATUS_OK) fga_task_restart(task);
  return status;
}

// Sets the mission, also in a manoeuvre. Its waypoints must stay where they are while it is flown.
// Refuses what fga_avoider_set_mission refuses.
static inline fga_status fga_task_set_mission(fga_task *task, const fga_mission *mission, fga_refusal *why) {
  const fga_status status = fga_avoider_set_mission(task->avoider, mission, why);
  if (status == FGA_STATUS_OK) {
    task->mission = *mission;
    task->first_waypoint = 0;
    task->other_leg_since_s = INFINITY;
  }
  return status;
}

// Index of the waypoint at the end of the present leg; the number of waypoints after the last one.
static inline uint32_t fga_task_next_waypoint(const fga_task *task) {
  const uint32_t next = task->first_waypoint + task->decision.leg_index + 1;
  return next < task->mission.waypoint_count ? next : task->mission.waypoint_count;
}

// Goes on with the leg that the autopilot flies, where that has been another one for a while.
static inline void fga_task_follow_leg(fga_task *task, uint32_t next_waypoint, double now_s) {
  const int is_other =
      next_waypoint > 0 && next_waypoint < task->mission.waypoint_count && next_waypoint != fga_task_next_waypoint(task);
  task->other_leg_since_s = is_other ? fmin(task->other_leg_since_s, now_s) : (double)INFINITY;
  if (now_s - task->other_leg_since_s < FGA_TASK_OTHER_LEG_S) return;
  fga_mission rest = task->mission;
  rest.waypoints += next_waypoint - 1;
  rest.waypoint_count -= next_waypoint - 1;
  task->other_leg_since_s = INFINITY;
  if (fga_avoider_set_mission(task->avoider, &rest, &task->why) == FGA_STATUS_OK) task->first_waypoint = next_waypoint - 1;
}

// Takes a report of traffic. Each is counted; of more aircraft than there is room for, the nearest stay. A report that cannot be used is
// refused, and `task->why` says why.
static inline void fga_task_hear(fga_task *task, const fga_report *report, double now_s) {
  const fga_task_settings *settings = &task->settings;
  const fga_enu own_m = task->ownship.position_m;
  const int is_believed = settings->beliefs && report->movement >= FGA_MOVEMENT_CREWED;
  fga_status status = fga_reports_hear(task->reports, report, now_s, own_m, &task->why);
  if (is_believed && status == FGA_STATUS_OK) {
    status = fga_beliefs_hear(settings->beliefs, report, settings->radius_m, settings->half_height_m, now_s, own_m, &task->why);
  }
  if (status != FGA_STATUS_OK) task->incomplete = 1;
}

// The present leg; null without one.
static inline const fga_waypoint *fga_task_leg(const fga_task *task) {
  const uint32_t next = fga_task_next_waypoint(task);
  if (next >= task->mission.waypoint_count) return NULL;
  const fga_enu from = task->mission.waypoints[next - 1].position_m, to = task->mission.waypoints[next].position_m;
  return hypot(to.east - from.east, to.north - from.north) < 1.0 ? NULL : &task->mission.waypoints[next - 1];
}

// Whether a course through the air leads along a leg over the ground.
static inline int fga_task_leads_along(const fga_task *task, const fga_waypoint *leg, double course_from_east_rad, fga_enu wind_mps) {
  const double along_east = leg[1].position_m.east - leg->position_m.east, along_north = leg[1].position_m.north - leg->position_m.north;
  const double level_mps = task->ownship.airspeed_mps * cos(task->ownship.climb_rad);
  const double east_mps = level_mps * cos(course_from_east_rad) + wind_mps.east;
  const double north_mps = level_mps * sin(course_from_east_rad) + wind_mps.north;
  const double angle_rad = atan2(along_east * north_mps - along_north * east_mps, along_east * east_mps + along_north * north_mps);
  return fabs(angle_rad) < FGA_TASK_ON_LEG_RAD;
}

// Whether the aircraft is on the present leg, by position and by its course over the ground; 1 without a leg.
static inline int fga_task_is_on_leg(const fga_task *task, fga_enu wind_mps) {
  const fga_waypoint *leg = fga_task_leg(task);
  if (!leg) return 1;
  const fga_enu from = leg->position_m, to = leg[1].position_m, at = task->ownship.position_m;
  const double length_m = hypot(to.east - from.east, to.north - from.north);
  const double along_east = (to.east - from.east) / length_m, along_north = (to.north - from.north) / length_m;
  const double east_m = at.east - from.east, north_m = at.north - from.north;
  const double share = fmax(0.0, fmin(1.0, (east_m * along_east + north_m * along_north) / length_m));
  const double above_m = at.up - (from.up + share * (to.up - from.up));
  const int climbs = task->settings.vehicle.climb_max_rad > 0.0;
  return fabs(along_east * north_m - along_north * east_m) < FGA_TASK_ON_LEG_M &&
         fga_task_leads_along(task, leg, task->ownship.course_from_east_rad, wind_mps) &&
         (!climbs || fabs(above_m) < FGA_TASK_ON_LEG_HEIGHT_M);
}

// Of the stages that have begun, the last one; null without one.
static inline const fga_stage *fga_task_stage(const fga_task *task, double now_s) {
  const fga_stage *stage = NULL;
  for (uint32_t k = 0; k < task->decision.stage_count && task->decision.stages[k].start_s <= now_s - task->decided_s; ++k) {
    stage = &task->decision.stages[k];
  }
  return stage;
}

// Whether the last turn of the way back has begun, or the way back is over; the end of a planned way leaves time for the slowest roll.
static inline int fga_task_is_way_over(const fga_task *task, fga_enu wind_mps, double now_s) {
  const fga_waypoint *leg = fga_task_leg(task);
  const fga_stage *stage = fga_task_stage(task, now_s);
  if (task->decision.state == FGA_STATE_CRUISE) return 1;
  return task->decision.state == FGA_STATE_RECOVERING && !(task->decision.has & FGA_HAS_THREAT) && leg && stage &&
         fga_task_leads_along(task, leg, stage->course_from_east_rad, wind_mps);
}

// Whether the mode can be given back: on the leg for a while, or nothing leads back.
static inline int fga_task_is_back(fga_task *task, fga_enu wind_mps, double now_s) {
  const int cruises = task->decision.state == FGA_STATE_CRUISE;
  const int on_way = fga_task_is_way_over(task, wind_mps, now_s) && fga_task_is_on_leg(task, wind_mps);
  if (cruises && task->decision.reason == FGA_REASON_MISSION_COMPLETE) return 1;
  task->beside_since_s = cruises ? fmin(task->beside_since_s, now_s) : (double)INFINITY;
  task->on_leg_since_s = on_way ? fmin(task->on_leg_since_s, now_s) : (double)INFINITY;
  return now_s - task->on_leg_since_s >= FGA_TASK_ON_LEG_FOR_S || now_s - task->beside_since_s >= FGA_TASK_LONGEST_WAY_BACK_S;
}

// The set-point of this moment. Full bank until the rest of the turn is what the roll to level still turns; then bank in proportion to
// what remains.
static inline void fga_task_set_point(fga_task *task, const fga_ownship *own, double now_s, fga_task_output *out) {
  const fga_vehicle *vehicle =
      task->decision.in_need && task->settings.in_need.size ? &task->settings.in_need : &task->settings.vehicle;
  const double lag_s = vehicle->bank_time_constant_s, speed_mps = own->airspeed_mps;
  const double ideal = 9.80665 * vehicle->turn_rate_factor / speed_mps;  // course rate per tan(bank)
  const fga_stage *stage = now_s - task->decided_s > FGA_TASK_STALE_S ? NULL : fga_task_stage(task, now_s);
  out->course_from_east_rad = own->course_from_east_rad;
  out->bank_left_rad = out->climb_rad = 0.0;
  if (stage) {
    const double most = stage->rate_share * vehicle->turn_rate_factor * vehicle->airspeed_mps / vehicle->turn_radius_m;
    const double rest_rad =
        stage->course_from_east_rad - own->course_from_east_rad - lag_s * ideal * tan(own->bank_left_rad);
    const double rate = fmax(-most, fmin(most, rest_rad / fmax(lag_s, FGA_TASK_SHORTEST_ROLL_OUT_S)));
    out->course_from_east_rad = stage->course_from_east_rad;
    out->bank_left_rad = atan(rate / ideal);
    out->climb_rad = stage->climb_rad;
  }
  if (fabs(out->climb_rad) > 0.004) {
    task->held_m = (double)NAN;
  } else {
    out->climb_rad = 0.0;
    if (!isfinite(task->held_m)) task->held_m = own->position_m.up;
  }
  out->altitude_m = isfinite(task->held_m) ? task->held_m : own->position_m.up;
}

static inline void fga_task_enter(fga_task *task, fga_task_phase phase, double now_s) {
  task->phase = phase;
  task->since_s = now_s;
  task->on_leg_since_s = task->beside_since_s = INFINITY;
}

// Somebody else flies: nothing is asked for a while.
static inline void fga_task_release(fga_task *task, double now_s) {
  fga_task_enter(task, FGA_TASK_WATCHES, now_s);
  task->pause_until_s = now_s + FGA_TASK_PAUSE_S;
}

// Whether the aircraft cannot have come from where it was decided last: a fault of its navigation, or another origin.
static inline int fga_task_jumps(const fga_task *task, const fga_task_input *in) {
  const fga_enu *const now = &in->ownship.position_m, *const before = &task->ownship.position_m;
  const double since_s = fabs(in->time_s - task->decided_s);
  const double off_m = hypot(hypot(now->east - before->east, now->north - before->north), now->up - before->up);
  return since_s < FGA_TASK_JUMP_S && off_m > FGA_TASK_JUMP_M + FGA_TASK_JUMP_MPS * since_s;
}

// Decides from a fresh state. A refused step is counted; the last decision is flown on until it is stale.
static inline void fga_task_decide(fga_task *task, const fga_task_input *in) {
  const fga_task_settings *settings = &task->settings;
  if (fga_task_jumps(task, in)) {
    task->counts.steps_refused += 1;
    return;
  }
  fga_situation situation;
  memset(&situation, 0, sizeof situation);
  situation.size = sizeof(fga_situation);
  fga_status status = fga_reports_obstacles(task->reports, in->time_s, settings->radius_m, settings->half_height_m, task->obstacles,
                                            FGA_TASK_TRAFFIC_MOST, &situation.obstacle_count, &task->why);
  situation.obstacles = task->obstacles;
  situation.time_s = in->time_s;
  situation.ownship = in->ownship;
  situation.wind_mps = in->wind_mps;
  situation.zone_count = in->zone_count;
  situation.zones = in->zones;
  situation.ground = in->ground;
  if (status == FGA_STATUS_OK) {
    status = settings->beliefs
                 ? fga_avoider_step_on_beliefs(task->avoider, settings->beliefs, &situation, &task->decision, &task->why)
                 : fga_avoider_step(task->avoider, &situation, &task->decision, &task->why);
  }
  if (status != FGA_STATUS_OK && status != FGA_STATUS_INCOMPLETE) {
    task->counts.steps_refused += 1;
    return;
  }
  task->decided_s = in->time_s;
  task->ownship = in->ownship;
  const int is_incomplete = status == FGA_STATUS_INCOMPLETE || task->incomplete;
  task->alarms &= ~(uint32_t)(FGA_TASK_ALARM_NO_STATE | FGA_TASK_ALARM_INCOMPLETE);
  task->alarms |= is_incomplete ? (uint32_t)FGA_TASK_ALARM_INCOMPLETE : 0u;
  task->incomplete = 0;
}

// Learns from a fresh state, the last one of which had this course and time; plans with what was learned when nothing threatens.
static inline void fga_task_learn(fga_task *task, const fga_task_input *in, double before_rad, double before_s, const fga_task_output *out) {
  const fga_ownship *own = &in->ownship;
  const double turned_rad = own->course_from_east_rad - before_rad;
  const double rate_radps = atan2(sin(turned_rad), cos(turned_rad)) / (in->time_s - before_s);
  const uint32_t has = in->mode == FGA_TASK_MODE_AVOID && out->commands && !in->pilot_hand ? FGA_SEEN_COMMAND : 0u;
  const fga_seen_state seen = {sizeof seen, has, in->time_s, own->bank_left_rad, rate_radps, own->airspeed_mps, out->bank_left_rad, {0, 0, 0}};
  fga_vehicle now = task->settings.vehicle;
  if (fga_learned_see(task->settings.learned, &seen, &task->why) != FGA_STATUS_OK || task->phase != FGA_TASK_WATCHES ||
      task->decision.state != FGA_STATE_CRUISE || fga_learned_vehicle(task->settings.learned, &now, &task->why) != FGA_STATUS_OK) return;
  now.bank_time_constant_s += now.dead_time_s;  // a step is given the state of its own moment
  now.dead_time_s = 0.0;
  fga_vehicle *const need = &task->settings.in_need, *const vehicle = &task->settings.vehicle;
  if (fga_avoider_set_vehicle(task->avoider, &now, &task->why) != FGA_STATUS_OK) return;
  if (need->size) {
    // What is flown in need answers as much worse, or better.
    need->turn_rate_factor *= now.turn_rate_factor / vehicle->turn_rate_factor;
    need->bank_time_constant_s = fmax(0.01, need->bank_time_constant_s + now.bank_time_constant_s - vehicle->bank_time_constant_s);
    (void)fga_avoider_set_vehicle_in_need(task->avoider, need, &task->why);
  }
  *vehicle = now;
}

// One period: what the autopilot is to do until the next one.
static inline void fga_task_step(fga_task *task, const fga_task_input *in, fga_task_output *out) {
  const double now_s = in->time_s;
  const int stopped = now_s - task->step_s > FGA_TASK_STALE_S && task->step_s > -INFINITY;
  const double before_rad = task->ownship.course_from_east_rad, before_s = task->decided_s;
  memset(out, 0, sizeof *out);
  task->step_s = now_s;
  if (stopped) task->counts.stops += 1;
  if (in->mode == FGA_TASK_MODE_OTHER) {
    // The pilot flies. The mission that flies next begins anew.
    if (task->phase == FGA_TASK_FLIES) task->counts.pilot_wins += 1;
    if (task->phase != FGA_TASK_WATCHES) fga_task_release(task, now_s);
    if (task->decided_s > -INFINITY) fga_task_restart(task);
    task->alarms = 0;
    return;
  }
  if (in->is_fresh) {
    fga_task_decide(task, in);
  } else {
    task->counts.steps_without_state += 1;
  }
  const int is_stale = now_s - task->decided_s > FGA_TASK_STALE_S;
  if (is_stale) task->alarms |= FGA_TASK_ALARM_NO_STATE;
  const fga_decision *decision = &task->decision;
  const int begins = !is_stale && (decision->state == FGA_STATE_AVOIDING ||
                                   (decision->state == FGA_STATE_THREATENED && (decision->has & FGA_HAS_START) &&
                                    decision->start_s < FGA_TASK_PREPARE_S));
  const int in_avoid = in->mode == FGA_TASK_MODE_AVOID;
  switch (task->phase) {
    case FGA_TASK_WATCHES:
      // A mode of avoidance that the task did not ask for is the pilot's.
      if (!in_avoid) fga_task_follow_leg(task, in->next_waypoint, now_s);
      if (!in_avoid && begins && !in->pilot_hand && now_s >= task->pause_until_s) fga_task_enter(task, FGA_TASK_ASKS, now_s);
      break;
    case FGA_TASK_ASKS:
      if (in_avoid) {
        task->counts.maneuvers += 1;
        task->alarms &= ~(uint32_t)FGA_TASK_ALARM_REFUSED;
        task->held_m = (double)NAN;
        fga_task_enter(task, FGA_TASK_FLIES, now_s);
      } else if (!begins || in->pilot_hand) {
        fga_task_enter(task, FGA_TASK_WATCHES, now_s);
      } else if (now_s - task->since_s >= FGA_TASK_REFUSED_S) {
        task->counts.refusals += 1;
        task->alarms |= FGA_TASK_ALARM_REFUSED;
        fga_task_release(task, now_s);
      }
      break;
    case FGA_TASK_FLIES:
      if (!in_avoid) {
        task->counts.pilot_wins += stopped ? 0u : 1u;  // else the watchdog gave it back
        fga_task_release(task, now_s);
      } else if (in->pilot_hand) {
        task->counts.pilot_wins += 1;
        fga_task_enter(task, FGA_TASK_RETURNS, now_s);
        task->pause_until_s = now_s + FGA_TASK_PAUSE_S;
      } else if (is_stale || fga_task_is_back(task, in->wind_mps, now_s)) {
        fga_task_enter(task, FGA_TASK_RETURNS, now_s);
      }
      break;
    case FGA_TASK_RETURNS:
      if (!in_avoid) {
        task->alarms &= ~(uint32_t)FGA_TASK_ALARM_NOT_RETURNED;
        fga_task_enter(task, FGA_TASK_WATCHES, now_s);
      } else if (now_s - task->since_s >= FGA_TASK_REFUSED_S) {
        task->alarms |= FGA_TASK_ALARM_NOT_RETURNED;  // asked for on, and flown on meanwhile
      }
      break;
  }
  const int commands = task->phase == FGA_TASK_FLIES || task->phase == FGA_TASK_RETURNS || task->phase == FGA_TASK_ASKS;
  if (task->phase == FGA_TASK_ASKS) out->request = FGA_TASK_REQUEST_AVOID;
  if (task->phase == FGA_TASK_RETURNS) out->request = FGA_TASK_REQUEST_MISSION;
  if (commands) {
    out->commands = 1;
    fga_task_set_point(task, in->is_fresh ? &in->ownship : &task->ownship, now_s, out);
  }
  // After refused steps the state before is an older one.
  const int follows = in->is_fresh && task->decided_s >= now_s && now_s > before_s && before_s > -INFINITY;
  if (task->settings.learned && follows) fga_task_learn(task, in, before_rad, before_s, out);
  const int is_unproven = decision->reason == FGA_REASON_BEST_AVAILABLE || decision->reason == FGA_REASON_INSIDE_VOLUME;
  task->alarms &= ~(uint32_t)FGA_TASK_ALARM_NOT_CERTIFIED;
  if (commands && task->phase != FGA_TASK_ASKS && is_unproven) task->alarms |= FGA_TASK_ALARM_NOT_CERTIFIED;
  out->alarms = task->alarms;
  out->next_waypoint = fga_task_next_waypoint(task);
}

// The watchdog, for another place than the one that calls fga_task_step: the request to make when the task has stopped.
static inline fga_task_request fga_task_watch(const fga_task *task, double now_s, fga_task_mode mode) {
  const int owns = task->phase == FGA_TASK_FLIES || task->phase == FGA_TASK_RETURNS;
  const int stands = now_s - task->step_s > FGA_TASK_STALE_S;
  return owns && stands && mode == FGA_TASK_MODE_AVOID ? FGA_TASK_REQUEST_MISSION : FGA_TASK_REQUEST_NONE;
}

#endif  // FGA_TASK_H
