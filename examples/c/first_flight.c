// The first avoided intruder: an autopilot of a few lines flies a leg to the east, an aircraft comes from ahead.
#include <fga_task.h>
#include <stdio.h>

static unsigned char storage[FGA_TASK_BYTES(2)];
static const fga_waypoint leg[2] = {{{0, 0, 100}, FGA_PASSING_FLY_BY}, {{3000, 0, 100}, FGA_PASSING_FLY_BY}};

int main(void) {
  fga_task task;
  fga_task_settings settings;
  fga_mission mission = {sizeof mission, 2, leg, -INFINITY, INFINITY};
  fga_refusal why = {.size = sizeof why};
  // 25 m/s, banks of up to 43 degrees.
  fga_status status = fga_task_settings_default(&settings, 25.0, 0.75, &why);
  if (!status) status = fga_task_begin(&task, &settings, storage, sizeof storage, 2, &why);
  if (!status) status = fga_task_set_mission(&task, &mission, &why);
  if (status) {
    fprintf(stderr, "%s: %s %g, expected %s\n", fga_status_text(status), why.field, why.value, why.expected);
    return 1;
  }
  fga_task_input in = {.mode = FGA_TASK_MODE_MISSION, .is_fresh = 1, .next_waypoint = 1};
  in.ownship = (fga_ownship){.position_m = {0, 0, 100}, .airspeed_mps = 25.0};
  double least_m = INFINITY;
  for (int step = 0; step < 1000; ++step) {
    in.time_s = step * FGA_TASK_PERIOD_S;
    // What a receiver hears, once a second.
    fga_enu other_m = {2250.0 - 20.0 * in.time_s, 0, 100};
    fga_report report = {sizeof report, 7, FGA_MOVEMENT_CREWED, 1, in.time_s, other_m, {-20, 0, 0}, 3.0, 0.5};
    if (step % 10 == 0) fga_task_hear(&task, &report, in.time_s);

    fga_task_output out;
    fga_task_step(&task, &in, &out);
    if (out.request == FGA_TASK_REQUEST_AVOID) in.mode = FGA_TASK_MODE_AVOID;
    if (out.request == FGA_TASK_REQUEST_MISSION) in.mode = FGA_TASK_MODE_MISSION;
    if (out.request) printf("%4.1f s: %s\n", in.time_s, in.mode == FGA_TASK_MODE_AVOID ? "avoiding" : "back on the leg");

    // The aircraft: its bank follows the set-point, on the mission one towards the leg.
    fga_ownship *own = &in.ownship;
    double bank = out.bank_left_rad;
    if (in.mode == FGA_TASK_MODE_MISSION) bank = fmax(-0.5, fmin(0.5, -own->course_from_east_rad - 0.01 * own->position_m.north));
    own->bank_left_rad += (bank - own->bank_left_rad) * FGA_TASK_PERIOD_S / 0.5;
    own->course_from_east_rad += 9.80665 * tan(own->bank_left_rad) / 25.0 * FGA_TASK_PERIOD_S;
    own->position_m.east += 25.0 * cos(own->course_from_east_rad) * FGA_TASK_PERIOD_S;
    own->position_m.north += 25.0 * sin(own->course_from_east_rad) * FGA_TASK_PERIOD_S;
    least_m = fmin(least_m, hypot(other_m.east - own->position_m.east, other_m.north - own->position_m.north));
  }
  printf("least distance %.0f m, volume of 60 m\n", least_m);
  return least_m < 60.0;
}
