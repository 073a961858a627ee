// A reference loop for an autopilot, called once a decision period: who owns the mode, when it is handed back, and what happens
// when the input stops. It commands nothing by itself: it answers what the autopilot should do, which has the last word.
//
//   the mission flies  --- a manoeuvre begins: TAKE --->  fga flies  --- on the mission again, or stale: GIVE_BACK --->  mission
//                                                             |
//                                                             +--- the pilot chooses another mode: nothing more is asked
//
// Copy it, and adapt what is marked HOST.

#ifndef REFERENCE_LOOP_H
#define REFERENCE_LOOP_H

#include "fga.h"

#include <math.h>
#include <stdbool.h>

// A decision older than this is flown no more, seconds: three periods.
#define LOOP_STALE_S 0.3

// HOST: the modes of the autopilot, as far as they matter here.
typedef enum { HOST_MISSION, HOST_AVOID, HOST_OTHER } host_mode;

typedef enum {
  LOOP_NOTHING,   // leave the autopilot alone
  LOOP_TAKE,      // change from the mission to the mode of fga, and fly the set-point
  LOOP_FLY,       // fly the set-point
  LOOP_GIVE_BACK  // change back to the mission
} loop_action;

// HOST: what the controllers of the autopilot track. Bank and course are those of fga: left is positive.
typedef struct {
  double bank_left_rad;
  double climb_rad;
} loop_set_point;

typedef struct {
  fga_avoider *avoider;
  fga_vehicle vehicle;
  fga_decision decision;  // the last one
  double decided_s;       // its time
  bool owns;              // whether the mode of fga was asked for
  bool alarm;             // a manoeuvre was given up, because decisions stopped: say so to the pilot
  uint32_t refused;       // steps that fga refused
  fga_refusal why;        // the last refusal
} reference_loop;

static inline void loop_begin(reference_loop *loop, fga_avoider *avoider, const fga_vehicle *vehicle) {
  *loop = (reference_loop){.avoider = avoider, .vehicle = *vehicle, .decided_s = -INFINITY};
  loop->decision.size = sizeof(fga_decision);
  loop->why.size = sizeof(fga_refusal);
}

// What the command asks for at this moment: of the stages that have begun, the last one.
static inline loop_set_point loop_command(const reference_loop *loop, double now_s, const fga_ownship *own) {
  const fga_decision *decision = &loop->decision;
  const double age_s = now_s - loop->decided_s;
  loop_set_point out = {.bank_left_rad = 0.0, .climb_rad = own->climb_rad};
  for (uint32_t k = 0; k < decision->stage_count && decision->stages[k].start_s <= age_s; ++k) {
    const fga_stage *stage = &decision->stages[k];
    const double most = stage->rate_share * loop->vehicle.turn_rate_factor * own->airspeed_mps / loop->vehicle.turn_radius_m;
    // The plain difference: it says to which side. Proportional near the end, so that the turn rolls out on its course.
    const double rate = fmax(-most, fmin(most, 2.0 * (stage->course_from_east_rad - own->course_from_east_rad)));
    out.bank_left_rad = atan(own->airspeed_mps * rate / (9.80665 * loop->vehicle.turn_rate_factor));
    out.climb_rad = stage->climb_rad;
  }
  return out;
}

// One period. `fresh` is the situation of this moment, or null without one; `own` is the last known state, for the set-point.
static inline loop_action loop_tick(reference_loop *loop, double now_s, host_mode mode, const fga_situation *fresh,
                                    const fga_ownship *own, loop_set_point *out) {
  // The pilot always wins. When the mission flies again, fga forgets the last flight.
  if (mode == HOST_OTHER) {
    if (loop->owns || loop->decided_s > -INFINITY) {
      (void)fga_avoider_restart(loop->avoider);
    }
    loop->owns = false;
    loop->decided_s = -INFINITY;
    return LOOP_NOTHING;
  }
  if (fresh) {
    const fga_status status = fga_avoider_step(loop->avoider, fresh, &loop->decision, &loop->why);
    if (status == FGA_STATUS_OK || status == FGA_STATUS_INCOMPLETE) {
      loop->decided_s = now_s;
    } else {
      loop->refused += 1;  // the last decision is flown on until it is stale
    }
  }
  const bool stale = now_s - loop->decided_s > LOOP_STALE_S;
  const bool maneuvers = loop->decision.state == FGA_STATE_AVOIDING || loop->decision.state == FGA_STATE_RECOVERING;
  if (loop->owns) {
    if (mode != HOST_AVOID) {
      loop->owns = false;  // the autopilot went back by itself, or never changed
      return LOOP_NOTHING;
    }
    if (stale || !maneuvers) {
      loop->owns = false;
      loop->alarm = stale;
      return LOOP_GIVE_BACK;
    }
    *out = loop_command(loop, now_s, own);
    return LOOP_FLY;
  }
  if (mode == HOST_MISSION && !stale && maneuvers) {
    loop->owns = true;
    loop->alarm = false;
    *out = loop_command(loop, now_s, own);
    return LOOP_TAKE;
  }
  return LOOP_NOTHING;
}

#endif  // REFERENCE_LOOP_H
