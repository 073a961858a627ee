// fga: real-time 3D collision avoidance for fixed-wing aircraft. C interface, for C99 and later; see fga.hpp for C++17.
//
// FRAME AND UNITS. Local tangent plane: east, north, up; metres, seconds, radians, and units in every name. A course counts
// from EAST towards NORTH (anticlockwise seen from above), so it grows in a LEFT turn, and a bank to the left is positive.
// From a heading and a roll of aviation: course_from_east_rad = pi/2 - heading_rad, bank_left_rad = -roll_rad.
// Obstacles, positions, velocities and wind are over the ground; the course and the climb angle of the aircraft are those of its
// motion through the air.
//
// MEMORY. The library allocates nothing and keeps no pointer of the caller. An avoider, a prover, a filter of reports or a
// learner lives in storage that the caller lends, aligned to FGA_ALIGN, which must not be moved or copied:
//     static _Alignas(FGA_ALIGN) unsigned char storage[FGA_AVOIDER_BYTES(16, 32)];
// What lies in the storage is the library's alone.
//
// STRUCTURES. Those that may grow begin with their size; the caller sets it, also where the library writes:
//     fga_situation situation = {.size = sizeof(fga_situation), ...};
// Others (vectors, stages, waypoints, ...) stay as they are within an FGA_ABI_VERSION.
//
// ANSWERS. Every call that can refuse answers an fga_status. FGA_STATUS_OK and FGA_STATUS_INCOMPLETE come with a result; after
// any other nothing has changed. Found are: null, misaligned and overlapping pointers, wrong sizes and versions, storage that is
// too small or holds nothing, numbers that are not finite or out of range, numbers that stand for nothing, and more than there
// is room for. `why`, which may be null, says which value and what was expected. No library can find a pointer to memory that
// is not there: what is not null must lead to what its type says, for lists to as many as their count says, and nobody may
// write there during the call.
//
// THREADS. One call at a time on one avoider or prover; a second one meanwhile is refused with FGA_STATUS_BUSY. Different
// avoiders and provers know nothing of one another: any threads may use them at the same time. A call takes no lock, never
// waits, and may be made from any thread or task, though not from an interrupt that shares its avoider with one.
//
// Made by cbindgen from crates/fga-c: do not edit.


#ifndef FGA_H
#define FGA_H

#include <stddef.h>
#include <stdint.h>

// Bytes of storage for an avoider with room for these numbers of obstacles a step and waypoints: for static storage.
#define FGA_AVOIDER_BYTES(obstacles, waypoints) \
  (FGA_AVOIDER_FIXED_BYTES + (obstacles) * FGA_AVOIDER_OBSTACLE_BYTES + (waypoints) * FGA_AVOIDER_WAYPOINT_BYTES \
   + ((obstacles) < FGA_AVOIDER_TRACKED_MOST ? (obstacles) : FGA_AVOIDER_TRACKED_MOST) * FGA_AVOIDER_TRACKED_BYTES)

// Bytes of storage for the reports of this number of aircraft: for static storage.
#define FGA_REPORTS_BYTES(aircraft) (FGA_REPORTS_FIXED_BYTES + (aircraft) * FGA_REPORTS_AIRCRAFT_BYTES)

// Version of this interface. It grows when a program compiled with an older header can no longer be linked.
#define FGA_ABI_VERSION 1

// Alignment of all storage, bytes.
#define FGA_ALIGN 16

// Most obstacles and most waypoints for which an avoider can have room, and most aircraft of reports.
#define FGA_CAPACITY_MOST 65536

// Most zones of a situation.
#define FGA_ZONES_MOST 32

// Most corners of a zone.
#define FGA_ZONE_CORNERS_MOST 256

// Most posts of a ground in a row, and most rows.
#define FGA_GROUND_POSTS_MOST 32768

// Bytes of an avoider without obstacles and waypoints; see `FGA_AVOIDER_BYTES`.
#define FGA_AVOIDER_FIXED_BYTES 51200

// Bytes of an avoider for each obstacle; see `FGA_AVOIDER_BYTES`.
#define FGA_AVOIDER_OBSTACLE_BYTES 152

// Bytes of an avoider for each obstacle that a decision considers; see `FGA_AVOIDER_BYTES`.
#define FGA_AVOIDER_TRACKED_BYTES 320

// Most obstacles that a decision considers: the most urgent ones.
#define FGA_AVOIDER_TRACKED_MOST 126

// Bytes of an avoider for each waypoint; see `FGA_AVOIDER_BYTES`.
#define FGA_AVOIDER_WAYPOINT_BYTES 32

// Bytes of storage for beliefs.
#define FGA_BELIEFS_BYTES 50688

// Most stages of a command.
#define FGA_STAGES_MOST 40

// Bit of `fga_decision::has`: there is a threat, `threat`.
#define FGA_HAS_THREAT 1

// Bit of `fga_decision::has`: there is a manoeuvre, flown or awaited, with `margin_m` and `cost`.
#define FGA_HAS_MANEUVER 2

// Bit of `fga_decision::has`: the manoeuvre is certified, with `certified_margin_m`, `certified_horizon_s` and
// `certified_hazards`.
#define FGA_HAS_CERTIFICATE 4

// Bit of `fga_decision::has`: the manoeuvre has a start, `start_s`.
#define FGA_HAS_START 8

// Bit of `fga_decision::has`: a latest start of a certified manoeuvre is known, `latest_start_s`.
#define FGA_HAS_LATEST_START 16

// Bit of `fga_decision::has`: what the manoeuvre withstands is known, `resilience`.
#define FGA_HAS_RESILIENCE 32

// Bit of `fga_decision::has`: the aircraft is already in a volume; what is proven is that it leaves it, and keeps clear of all
// others, `certified_...`. It excludes `FGA_HAS_CERTIFICATE`.
#define FGA_HAS_LEAVING 64

// Bit of `fga_decision::has`: chances of a loss are known, `p_loss_hold` and `p_loss`.
#define FGA_HAS_CHANCES 128

// Bit of `fga_decision::has`: the share of what aircraft may do that the certificate covers is known, `proven_share`.
#define FGA_HAS_PROVEN_SHARE 256

// Bytes of storage for a learner.
#define FGA_LEARNED_BYTES 5120

// Bit of `fga_seen_state::has`: a bank is commanded, `bank_command_left_rad`.
#define FGA_SEEN_COMMAND 1

// Bit of `fga_seen_state::has`: the velocity over the ground was measured, `velocity_mps`.
#define FGA_SEEN_VELOCITY 2

// Bit of `fga_known_aircraft::has`: of `turn_rate_factor` the flight weighs more than what is believed beforehand.
#define FGA_KNOWN_TURN_RATE 1

// Bit of `fga_known_aircraft::has`: of `bank_time_constant_s`, `dead_time_s` and `late_s` the flight weighs more than that.
#define FGA_KNOWN_LAG 2

// Bit of `fga_known_aircraft::has`: of both parts of the wind the flight weighs more than what is believed beforehand.
#define FGA_KNOWN_WIND 4

// Bytes of storage for a prover.
#define FGA_PROVER_BYTES 39936

// Most obstacles of a proof.
#define FGA_PROVER_OBSTACLES_MOST 128

// Bytes of storage for reports without aircraft; see `FGA_REPORTS_BYTES`.
#define FGA_REPORTS_FIXED_BYTES 128

// Bytes of storage for reports for each aircraft; see `FGA_REPORTS_BYTES`.
#define FGA_REPORTS_AIRCRAFT_BYTES 512

// Bytes of `fga_refusal::field`, with the zero at its end.
#define FGA_REFUSAL_FIELD_BYTES 48

// Bytes of `fga_refusal::expected`, with the zero at its end.
#define FGA_REFUSAL_EXPECTED_BYTES 80

// The answer of a call. `FGA_STATUS_OK` and `FGA_STATUS_INCOMPLETE` come with a result; after any other
// nothing has changed, and nothing is written but the refusal.
enum fga_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Done.
  FGA_STATUS_OK = 0,
  // Done without some obstacles: a number of theirs is unusable, or there is no room for them.
  FGA_STATUS_INCOMPLETE = 1,
  // A pointer is null.
  FGA_STATUS_NULL = 2,
  // The size at the beginning of a structure is not that of this version of the library.
  FGA_STATUS_WRONG_SIZE = 3,
  // The caller was compiled with the header of another version of the interface.
  FGA_STATUS_WRONG_VERSION = 4,
  // A pointer is not aligned for what it points to.
  FGA_STATUS_MISALIGNED = 5,
  // The storage is too small.
  FGA_STATUS_STORAGE_TOO_SMALL = 6,
  // Two of the pointers lead to memory that overlaps.
  FGA_STATUS_ALIASED = 7,
  // The storage holds no such object: it was never initialized, or it was moved.
  FGA_STATUS_NOT_INITIALIZED = 8,
  // Another call is at work on this object.
  FGA_STATUS_BUSY = 9,
  // A number is not finite or out of range; the refusal names it.
  FGA_STATUS_OUT_OF_RANGE = 10,
  // A number stands for none of the values of its enumeration; the refusal names it.
  FGA_STATUS_UNKNOWN_VALUE = 11,
  // More than there is room for; the refusal names it.
  FGA_STATUS_TOO_MANY = 12,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fga_status fga_status;
#else
typedef uint32_t fga_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// State of the avoider.
enum fga_state
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // On the mission, nothing threatens: the command is the guidance along the mission.
  FGA_STATE_CRUISE = 0,
  // A threat is known; the manoeuvre waits for its start.
  FGA_STATE_THREATENED = 1,
  // Flying the avoiding manoeuvre.
  FGA_STATE_AVOIDING = 2,
  // Flying back to the mission, until the aircraft is on its leg.
  FGA_STATE_RECOVERING = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fga_state fga_state;
#else
typedef uint32_t fga_state;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The reason of a decision.
enum fga_reason
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Nothing comes too close on the mission.
  FGA_REASON_CLEAR = 0,
  // A number is unusable; the aircraft holds course and climb angle. This interface refuses such a step instead.
  FGA_REASON_INVALID_INPUT = 1,
  // A threat is seen; its manoeuvre begins later.
  FGA_REASON_WAITING_FOR_START = 2,
  // A certified manoeuvre begins.
  FGA_REASON_MANEUVER_CHOSEN = 3,
  // The manoeuvre continues.
  FGA_REASON_MANEUVER_KEPT = 4,
  // Another manoeuvre replaces it: a better one, or it was no longer certified.
  FGA_REASON_MANEUVER_REPLACED = 5,
  // No manoeuvre is certified: the manoeuvre that keeps farthest away flies.
  FGA_REASON_BEST_AVAILABLE = 6,
  // The aircraft is inside a protected volume or a zone, and leaves it.
  FGA_REASON_INSIDE_VOLUME = 7,
  // A way back to the mission begins.
  FGA_REASON_REJOIN_CHOSEN = 8,
  // The way back continues.
  FGA_REASON_REJOIN_KEPT = 9,
  // The aircraft is back on its leg: within 15 m of it, beside and where it can climb in height, and 0.2 radians of its course.
  FGA_REASON_REJOINED = 10,
  // The aircraft passed the last waypoint; it holds course and altitude.
  FGA_REASON_MISSION_COMPLETE = 11,
  // The wind is too strong to reach any waypoint ahead; the aircraft flies against it.
  FGA_REASON_WIND_TOO_STRONG = 12,
  // Obstacles at rest have kept the aircraft from the waypoint ahead for 120 s: the mission goes on with the next one.
  FGA_REASON_WAYPOINT_GIVEN_UP = 13,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fga_reason fga_reason;
#else
typedef uint32_t fga_reason;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What a proof came to.
enum fga_verdict
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Nothing is proven: the work ended before the whole flight was examined.
  FGA_VERDICT_LIMIT_MET = 0,
  // The manoeuvre comes closer to an obstacle than was asked for, or the proof cannot exclude it.
  FGA_VERDICT_BELOW_TARGET = 1,
  // The manoeuvre keeps the separation asked for from every obstacle, up to the horizon, in continuous time.
  FGA_VERDICT_PROVEN = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fga_verdict fga_verdict;
#else
typedef uint32_t fga_verdict;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// When a manoeuvre begins.
enum fga_start
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Chosen with the manoeuvre for the least departure from the mission.
  FGA_START_FREE = 0,
  // At once, when the threat is first seen.
  FGA_START_AT_DETECTION = 1,
  // At the latest certified start.
  FGA_START_LATEST = 2,
  // At `start_score` times that, from 0 to 1.
  FGA_START_SCORE = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fga_start fga_start;
#else
typedef uint32_t fga_start;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What the cheapest manoeuvre is.
enum fga_objective
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Least cost of the changes of course and climb angle.
  FGA_OBJECTIVE_PAPER_COST = 0,
  // Least distance from the mission.
  FGA_OBJECTIVE_LEAST_DEVIATION = 1,
  // Least extra path.
  FGA_OBJECTIVE_SHORTEST_PATH = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fga_objective fga_objective;
#else
typedef uint32_t fga_objective;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How the aircraft passes a waypoint.
enum fga_passing
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // It turns before the waypoint onto the next leg.
  FGA_PASSING_FLY_BY = 0,
  // It turns after the waypoint, which it passes within 5 m.
  FGA_PASSING_FLY_OVER = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fga_passing fga_passing;
#else
typedef uint32_t fga_passing;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What a zone is for.
enum fga_zone_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The aircraft keeps out of it.
  FGA_ZONE_KIND_KEEP_OUT = 0,
  // The aircraft keeps within it.
  FGA_ZONE_KIND_KEEP_IN = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fga_zone_kind fga_zone_kind;
#else
typedef uint32_t fga_zone_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The form of a protected volume.
enum fga_volume
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // A sphere of `radius_m`.
  FGA_VOLUME_SPHERE = 1,
  // An upright cylinder of `radius_m` that reaches `half_height_m` above and below the obstacle.
  FGA_VOLUME_CYLINDER = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fga_volume fga_volume;
#else
typedef uint32_t fga_volume;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The possible motion of an obstacle from now on. A decision relies on it.
enum fga_movement
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // It stays at its position: its velocity is 0, but for noise where `velocity_sigma_mps` is above 0.
  FGA_MOVEMENT_AT_REST = 1,
  // It keeps its velocity over the ground: optimistic for an aircraft.
  FGA_MOVEMENT_STRAIGHT = 2,
  // A crewed aircraft: turns of 3 degrees a second, 6 for some seconds, 60 in all; changes of climb of 2.54 m/s; 0.5 m/s2.
  FGA_MOVEMENT_CREWED = 3,
  // A small unmanned aircraft: 15 degrees a second, 37 for some seconds, 90 in all; 2.5 m/s; 2 m/s2.
  FGA_MOVEMENT_SMALL_UAS = 4,
  // An aircraft within the bounds of the obstacle.
  FGA_MOVEMENT_BOUNDED = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum fga_movement fga_movement;
#else
typedef uint32_t fga_movement;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Collision avoidance for one aircraft, in storage of the caller. It holds no address of anything outside of that.
typedef struct fga_avoider fga_avoider;

// What is believed of at most 16 aircraft, in storage of the caller, for one avoider. It holds no address of anything outside of that.
typedef struct fga_beliefs fga_beliefs;

// What the aircraft's own flight shows of it and the wind, in storage of the caller. It holds no address of anything outside of that.
typedef struct fga_learned fga_learned;

// Proves manoeuvres of one vehicle, in storage of the caller. It holds no address of anything else.
typedef struct fga_prover fga_prover;

// What is known of other aircraft by their reports, in storage of the caller. It holds no address of anything outside of that.
typedef struct fga_reports fga_reports;

// Settings of the decisions. `fga_settings_default` fills it; then adapt it.
typedef struct fga_settings {
  // `sizeof(fga_settings)`.
  uint32_t size;
  // When a manoeuvre begins: an `fga_start`; by default `FGA_START_FREE`.
  uint32_t start;
  // The share of `FGA_START_SCORE`, 0 to 1; otherwise not read.
  double start_score;
  // Time from one step to the next, seconds: 0.001 to 10; by default 0.1.
  double decision_period_s;
  // Obstacles farther away than this are not considered, metres, above 0; by default `INFINITY`, which considers all.
  double surveillance_radius_m;
  // How far ahead a manoeuvre is proven, seconds: 1 to 600; by default 60.
  double horizon_s;
  // Distance kept beyond the protected volumes, metres: 0 to 10,000; by default 0.05.
  double margin_m;
  // Standard deviation of the velocity with which gusts and the autopilot carry the aircraft off its prediction, as known
  // beforehand, metres per second: 0 to 100. It is measured in flight too; by default 0.
  double drift_mps;
  // Standard deviations of an obstacle's uncertainty by which its volume grows: 0 to 10; by default 3.
  double confidence_sigmas;
  // Cost of a change of course, per radian: 0 to 1e6; by default 0.2.
  double heading_cost;
  // Cost of a change of climb angle, per radian: 0 to 1e6; by default 0.5.
  double pitch_cost;
  // What the cheapest manoeuvre is: an `fga_objective`; by default `FGA_OBJECTIVE_PAPER_COST`.
  uint32_t objective;
  // Most work of one step, in tests of a line against four obstacles: 10,000 to 1e9; by default 100000.
  uint32_t work_limit;
  // Price of a loss of a protected volume on beliefs, in metres of departure from the mission: 100 to 1e7; by default 42000.
  double loss_price_m;
} fga_settings;

// The limits of the aircraft at its airspeed. `fga_vehicle_from_bank` fills it; then adapt it.
typedef struct fga_vehicle {
  // `sizeof(fga_vehicle)`.
  uint32_t size;
  // Constant total airspeed, metres per second: 1 to 1,000.
  double airspeed_mps;
  // Least radius of the coordinated turn, metres: 1 to 1,000,000, and no turn of more than 10 g.
  double turn_radius_m;
  // Steepest descent, radians: -80 degrees to 0.
  double climb_min_rad;
  // Steepest climb, radians: 0 to 80 degrees; with 0 and 0 the aircraft stays at its altitude.
  double climb_max_rad;
  // Largest rate of the climb angle, radians per second: 0 to 10.
  double climb_rate_radps;
  // Delay from a command to its first effect, 0 to 10 seconds. With a delay, pass to a step the state predicted for its end
  // (`fga_predict`).
  double dead_time_s;
  // Time constant of the first-order response of the bank, seconds: 0, or 0.01 to 10.
  double bank_time_constant_s;
  // Flown course rate over the ideal g tan(bank) / airspeed: 0.05 to 2, and 1 for the ideal turn.
  double turn_rate_factor;
} fga_vehicle;

// What was refused, written by a call that answers `FGA_STATUS_OUT_OF_RANGE`, `FGA_STATUS_UNKNOWN_VALUE` or
// `FGA_STATUS_TOO_MANY`; by a step also for the first obstacle that it ignores.
typedef struct fga_refusal {
  // `sizeof(fga_refusal)`.
  uint32_t size;
  // Index in its list, of a waypoint, an obstacle or a stage; otherwise 0.
  uint32_t index;
  // The value.
  double value;
  // Name of the field or the argument.
  char field[FGA_REFUSAL_FIELD_BYTES];
  // What was expected, in words.
  char expected[FGA_REFUSAL_EXPECTED_BYTES];
} fga_refusal;

// A vector in the local frame: east, north, up.
typedef struct fga_enu {
  // East.
  double east;
  // North.
  double north;
  // Up.
  double up;
} fga_enu;

// A waypoint of the mission.
typedef struct fga_waypoint {
  // Its place, metres.
  struct fga_enu position_m;
  // How the aircraft passes it: an `fga_passing`.
  uint32_t passing;
} fga_waypoint;

// The mission: from each waypoint to the next along the straight leg. With fewer than two waypoints the aircraft holds its
// course and altitude.
typedef struct fga_mission {
  // `sizeof(fga_mission)`.
  uint32_t size;
  // Number of waypoints.
  uint32_t waypoint_count;
  // The waypoints, first to last; they are copied.
  const struct fga_waypoint *waypoints;
  // Lowest altitude that a manoeuvre may come to, metres up; `-INFINITY` without a limit.
  double floor_m;
  // Highest altitude that a manoeuvre may come to, metres up; `INFINITY` without a limit.
  double ceiling_m;
} fga_mission;

// The bounds of an aircraft, none below 0.
typedef struct fga_bounds {
  // Sustained turn rate, radians per second.
  double turn_rate_radps;
  // Turn rate for some seconds, radians per second.
  double brief_turn_rate_radps;
  // Turn that a decision withstands where possible, radians.
  double turn_rad;
  // Change of its vertical speed, metres per second.
  double climb_change_mps;
  // Change of its speed, metres per second squared.
  double acceleration_mps2;
} fga_bounds;

// An obstacle: a point that moves inside its protected volume.
typedef struct fga_obstacle {
  // `sizeof(fga_obstacle)`.
  uint32_t size;
  // Its identifier, the same from step to step, and unique among the obstacles of a step.
  uint32_t id;
  // Centre of its volume now, metres.
  struct fga_enu position_m;
  // Velocity over the ground, metres per second.
  struct fga_enu velocity_mps;
  // The form of its volume: an `fga_volume`. There is no default.
  uint32_t volume;
  // Its possible motion: an `fga_movement`. There is no default.
  uint32_t movement;
  // Radius of its volume, metres, 0 or more.
  double radius_m;
  // Half height of a cylinder, metres, 0 or more; of a sphere not read.
  double half_height_m;
  // Standard deviation of its position along any axis, metres; 0 if known exactly.
  double position_sigma_m;
  // Standard deviation of its velocity along any axis, metres per second; 0 if known exactly.
  double velocity_sigma_mps;
  // Age of the report from which its position and velocity are carried on, seconds: its motion may have changed since. One below 0 counts as 0.
  double age_s;
  // The bounds of `FGA_MOVEMENT_BOUNDED`; otherwise not read.
  struct fga_bounds bounds;
} fga_obstacle;

// The state of the aircraft in the air mass.
typedef struct fga_ownship {
  // Position, metres.
  struct fga_enu position_m;
  // Course through the air, radians from east towards north; any number of turns.
  double course_from_east_rad;
  // Climb angle, radians, positive upwards.
  double climb_rad;
  // Bank angle, radians, positive in a left turn.
  double bank_left_rad;
  // Total airspeed, metres per second, above 0.
  double airspeed_mps;
} fga_ownship;

// A place over the ground, or a distance east and north.
typedef struct fga_place {
  // East, metres.
  double east_m;
  // North, metres.
  double north_m;
} fga_place;

// A zone: what is above a polygon or a circle between two altitudes. What an odd number of the edges of a polygon surrounds is
// inside.
typedef struct fga_zone {
  // What it is for: an `fga_zone_kind`.
  uint32_t kind;
  // Number of corners of a polygon: 3 to `FGA_ZONE_CORNERS_MOST`; 0 for a circle.
  uint32_t corner_count;
  // The corners of a polygon in order, either way round; they are read during the call only.
  const struct fga_place *corners;
  // Centre of a circle.
  struct fga_place center;
  // Radius of a circle, metres, above 0.
  double radius_m;
  // Its floor, metres up; `-INFINITY` without one.
  double floor_m;
  // Its ceiling, metres up; `INFINITY` without one.
  double ceiling_m;
} fga_zone;

// Heights of the ground on a regular grid, bilinear in between. Outside of it, and where a height is not a number, the ground is
// unknown: no manoeuvre leads there by choice.
typedef struct fga_ground {
  // `sizeof(fga_ground)`.
  uint32_t size;
  // Posts in a row, from the west to the east: 2 to `FGA_GROUND_POSTS_MOST`.
  uint32_t columns;
  // Rows, from the south to the north: 2 to `FGA_GROUND_POSTS_MOST`.
  uint32_t rows;
  // The south-west post.
  struct fga_place corner;
  // Distance from post to post, metres, above 0.
  struct fga_place spacing;
  // Heights of the posts, metres up, row by row; they are read during the call only.
  const float *heights_m;
  // The largest heights of blocks, which `fga_ground_fill_peaks` has filled in from these heights: `fga_ground_peak_count` of
  // them. Others make the ground another one.
  const float *peaks_m;
  // Vertical error of the heights, metres.
  double error_m;
  // Height above the ground that is asked for, metres, beyond the error.
  double clearance_m;
} fga_ground;

// What is around the aircraft at a moment. Positions and velocities are over the ground.
typedef struct fga_situation {
  // `sizeof(fga_situation)`.
  uint32_t size;
  // Number of obstacles.
  uint32_t obstacle_count;
  // The obstacles; they are read during the call only.
  const struct fga_obstacle *obstacles;
  // Time of the state, seconds on any clock that does not run backwards.
  double time_s;
  // The aircraft. Its course and climb angle describe its motion through the air.
  struct fga_ownship ownship;
  // Velocity of the air over the ground, metres per second.
  struct fga_enu wind_mps;
  // Number of zones: at most `FGA_ZONES_MOST`.
  uint32_t zone_count;
  // The zones; they and their corners are read during the call only.
  const struct fga_zone *zones;
  // The ground, read during the call only; null where it is not known and not asked for.
  const struct fga_ground *ground;
} fga_situation;

// A command from a moment on, until the next stage begins.
typedef struct fga_stage {
  // Its start, seconds from the decision; at 0 or below it has begun.
  double start_s;
  // Course to turn to, radians from east towards north. Not wrapped: the aircraft turns by the plain difference to its own
  // course, which says to which side, and may be more than half a turn.
  double course_from_east_rad;
  // Climb angle to take up, radians, positive upwards.
  double climb_rad;
  // Share of the largest course rate to turn with, above 0 and up to 1.
  double rate_share;
} fga_stage;

// The obstacle that a decision is about.
typedef struct fga_threat {
  // The obstacle's identifier.
  uint32_t id;
  // Time of the entry into its volume on the mission, seconds from now.
  double entry_s;
  // Time of the closest approach, seconds from now.
  double closest_s;
  // Separation from its volume at that time, metres; negative inside.
  double margin_m;
} fga_threat;

// The command until the next step, and its reasons.
typedef struct fga_decision {
  // `sizeof(fga_decision)`.
  uint32_t size;
  // State of the avoider.
  fga_state state;
  // The reason.
  fga_reason reason;
  // Number of stages of the command. With none, or before the first one, the aircraft holds course and climb angle.
  uint32_t stage_count;
  // The command: of the stages that have begun, fly the last one.
  struct fga_stage stages[FGA_STAGES_MOST];
  // Which of the following parts mean something, as bits `FGA_HAS_...`; the others are 0.
  uint32_t has;
  // Whether the limits in need apply (1), because nothing was certified with the normal ones, or not (0).
  uint32_t in_need;
  // The most urgent threat.
  struct fga_threat threat;
  // Lower bound of the manoeuvre's separation beyond every volume, metres.
  double margin_m;
  // Cost of the manoeuvre.
  double cost;
  // Proven lower bound of the separation beyond every volume, metres.
  double certified_margin_m;
  // How far ahead it is proven, seconds.
  double certified_horizon_s;
  // Start of the manoeuvre, seconds from now.
  double start_s;
  // Latest start of a certified manoeuvre, seconds from now.
  double latest_start_s;
  // Share of the bounds of aircraft that the manoeuvre withstands, 0 (the expected motion) to 1.
  double resilience;
  // Number of hazards that the manoeuvre is proven against; an aircraft that may turn is several.
  uint32_t certified_hazards;
  // Number of aircraft that count as flying straight on, because only the turns of the nearest ones are considered.
  uint32_t straight_aircraft;
  // Obstacles of this step within the surveillance radius.
  uint32_t obstacles_tracked;
  // Obstacles of this step without effect, because a number of theirs is unusable.
  uint32_t obstacles_ignored;
  // Obstacles of this step without effect, because the storage has no room for them.
  uint32_t obstacles_left_out;
  // Work done, in the unit of `work_limit`.
  uint32_t work;
  // Whether the step met its limit of work before the search ended (1), or not (0).
  uint32_t work_limit_met;
  // Whether the clock was set back by more than a second since the last step (1), which makes the avoider forget its
  // plan, or not (0).
  uint32_t clock_set_back;
  // Index of the waypoint at the start of the present leg.
  uint32_t leg_index;
  // Chance to enter a protected volume on the mission, 0 to 1.
  double p_loss_hold;
  // The same on what is flown.
  double p_loss;
  // Weight of what aircraft may do of which the manoeuvre keeps clear by its certificate, 0 to 1.
  double proven_share;
} fga_decision;

// What an avoider has done and refused since it was initialized. The counts stay at their largest value.
typedef struct fga_counts {
  // `sizeof(fga_counts)`.
  uint32_t size;
  // Steps with a decision.
  uint32_t steps;
  // Calls on this avoider that refused what they were given.
  uint32_t refused_calls;
  // Steps without some of their obstacles.
  uint32_t incomplete_steps;
  // Obstacles without effect, because a number of theirs was unusable, all steps together.
  uint32_t obstacles_ignored;
  // Obstacles without effect, because there was no room for them, all steps together.
  uint32_t obstacles_left_out;
} fga_counts;

// A report of an aircraft or another obstacle, raw as it came, over the ground.
typedef struct fga_report {
  // `sizeof(fga_report)`.
  uint32_t size;
  // Its identifier, the same in each report, such as the ICAO address.
  uint32_t id;
  // Its possible motion: an `fga_movement` but `FGA_MOVEMENT_BOUNDED`. There is no default.
  uint32_t movement;
  // Whether the report has a velocity (1), or not (0).
  uint32_t has_velocity;
  // The moment of its position, seconds, on the clock of the caller.
  double time_s;
  // Position, metres.
  struct fga_enu position_m;
  // Velocity over the ground, metres per second; without one not used, nor of what rests.
  struct fga_enu velocity_mps;
  // Standard deviation of the position along any axis, metres, 0 or more.
  double position_sigma_m;
  // Standard deviation of the velocity along any axis, metres per second, 0 or more.
  double velocity_sigma_mps;
  // Standard deviation of the altitude, metres; 0 means that of the position.
  double altitude_sigma_m;
  // Standard deviation of an error of the position that lasts from report to report, metres, 0 or more.
  double lasting_position_sigma_m;
  // The same of the altitude, as of pressure altitude, metres, 0 or more.
  double lasting_altitude_sigma_m;
} fga_report;

// What became of reports. The counts stay at their largest value.
typedef struct fga_report_counts {
  // `sizeof(fga_report_counts)`.
  uint32_t size;
  // Reports given.
  uint32_t heard;
  // Of these, refused: a number that is not finite or negative, no such movement, or from the future.
  uint32_t unusable;
  // Of these, older than one of the same aircraft, or than the lifetime.
  uint32_t late;
  // Times that an aircraft had no room: the farthest one was left out.
  uint32_t left_out;
} fga_report_counts;

// A measured state of the aircraft, as raw as there is: what a filter has delayed adds to the lag.
typedef struct fga_seen_state {
  // `sizeof(fga_seen_state)`.
  uint32_t size;
  // What else is known, bits `FGA_SEEN_...`.
  uint32_t has;
  // When it was measured, seconds.
  double time_s;
  // Bank angle, radians, positive in a left turn. 1.4 and more shows nothing.
  double bank_left_rad;
  // Rate of turn about the vertical, or of the course through the air, radians per second, positive to the left.
  double turn_rate_left_radps;
  // Total airspeed, metres per second. Below 3 and from 300 on it shows nothing: the aircraft does not fly.
  double airspeed_mps;
  // Bank that is commanded from now until the next state, radians, positive to the left; without `FGA_SEEN_COMMAND` not read.
  double bank_command_left_rad;
  // Velocity over the ground, metres per second, of which the way up does not count; without `FGA_SEEN_VELOCITY` not read.
  struct fga_enu velocity_mps;
} fga_seen_state;

// A value and the interval in which it lies; of drawn aircraft the truth was inside at least 97 times of 100.
typedef struct fga_interval {
  // Lower end.
  double low;
  // The value that is expected.
  double mean;
  // Upper end.
  double high;
} fga_interval;

// What is known of the aircraft and the wind. Without evidence it is what is believed beforehand.
typedef struct fga_known_aircraft {
  // `sizeof(fga_known_aircraft)`.
  uint32_t size;
  // Of what the flight weighs more than what is believed beforehand, bits `FGA_KNOWN_...`.
  uint32_t has;
  // Flown course rate over g tan(bank) / airspeed.
  struct fga_interval turn_rate_factor;
  // Time constant of the first-order response of the bank, seconds.
  struct fga_interval bank_time_constant_s;
  // Delay from a command to its first effect, seconds.
  struct fga_interval dead_time_s;
  // Dead time and time constant together, seconds: known better than either.
  struct fga_interval late_s;
  // Velocity of the air to the east, metres per second.
  struct fga_interval wind_east_mps;
  // Velocity of the air to the north, metres per second.
  struct fga_interval wind_north_mps;
} fga_known_aircraft;

// What is asked of a manoeuvre.
typedef struct fga_question {
  // `sizeof(fga_question)`.
  uint32_t size;
  // Most work of the proof, in tests of a line against four obstacles.
  uint32_t work_limit;
  // How far ahead, seconds: above 0, to 600.
  double horizon_s;
  // Separation to be proven beyond every volume, metres, 0 to 10,000.
  double target_m;
  // Standard deviations of an obstacle's uncertainty by which its volume grows: 0 to 10.
  double confidence_sigmas;
} fga_question;

// What is proven about a manoeuvre.
typedef struct fga_certificate {
  // `sizeof(fga_certificate)`.
  uint32_t size;
  // What the proof came to.
  fga_verdict verdict;
  // Lower bound of the separation beyond every volume, metres, as far as it was examined: negative inside a volume, and no more
  // than `target_m` where that is proven.
  double margin_m;
  // Where the target is not proven: time of the least separation, seconds from the decision.
  double at_s;
  // Where the target is not proven: identifier of the obstacle that comes closest. Else 0, as where that is a zone or the ground.
  uint32_t obstacle_id;
  // Number of obstacles that the proof covers.
  uint32_t obstacle_count;
  // Of these, the aircraft: the proof takes them to keep their velocity, and does not cover their turns and climbs.
  uint32_t straight_aircraft;
  // Work done, in the unit of `work_limit`.
  uint32_t work;
} fga_certificate;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The version of the interface of the linked library: the program's header has it as `FGA_ABI_VERSION`.
uint32_t fga_abi_version(void);

// Number of the largest heights of blocks of a ground; 0 where its posts are too few or too many.
uint32_t fga_ground_peak_count(uint32_t columns, uint32_t rows);

// Fills in the largest heights of blocks of a ground, `fga_ground_peak_count` of them, once for heights that stay.
//
// Refuses `NULL`, `MISALIGNED`, `ALIASED`, `OUT_OF_RANGE`.
fga_status fga_ground_fill_peaks(uint32_t columns,
                                 uint32_t rows,
                                 const float *heights_m,
                                 float *peaks_m);

// Bytes of storage for an avoider with room for these numbers of obstacles a step and waypoints; 0 where one is above
// `FGA_CAPACITY_MOST`. For static storage the macro `FGA_AVOIDER_BYTES` gives the same.
size_t fga_avoider_size(uint32_t obstacles_most,
                        uint32_t waypoints_most);

// Alignment of the storage of an avoider, bytes: `FGA_ALIGN`.
size_t fga_avoider_align(void);

// Fills settings, but for their size, with the defaults.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`.
fga_status fga_settings_default(struct fga_settings *settings);

// Fills the limits of a vehicle, but for their size: it turns as tightly as its largest bank angle allows, without delay, and
// stays at its altitude. Adapt them to what the aircraft flies.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `OUT_OF_RANGE`.
fga_status fga_vehicle_from_bank(double airspeed_mps,
                                 double bank_max_rad,
                                 struct fga_vehicle *vehicle,
                                 struct fga_refusal *why);

// Constructs an avoider in storage of the caller, in cruise, without a mission.
//
// The storage stays the caller's: it must live as long as the avoider is used, and it is given up by using it no more. It must
// not be moved or copied. `abi_version` is `FGA_ABI_VERSION`. An avoider that lay in this storage is gone, whatever the answer.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `WRONG_VERSION`, `STORAGE_TOO_SMALL`, `ALIASED`, `OUT_OF_RANGE`,
// `UNKNOWN_VALUE`, `TOO_MANY`.
fga_status fga_avoider_init(void *storage,
                            size_t storage_size,
                            uint32_t abi_version,
                            uint32_t obstacles_most,
                            uint32_t waypoints_most,
                            const struct fga_settings *settings,
                            const struct fga_vehicle *vehicle,
                            struct fga_avoider **avoider,
                            struct fga_refusal *why);

// Sets the mission, whose waypoints are copied. It may be replaced at any time, also while a manoeuvre is flown, which then leads back
// to the new mission.
//
// The new mission begins at its first leg, by a turn round where that ends behind the aircraft, or at the first leg that the aircraft can
// join. Where both missions have the same waypoints up to the end of the present leg, or of a mission that is complete, the flight
// goes on from there. The same waypoints again change nothing.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`, `UNKNOWN_VALUE`, `TOO_MANY`;
// then the mission stays as it was.
fga_status fga_avoider_set_mission(struct fga_avoider *avoider,
                                   const struct fga_mission *mission,
                                   struct fga_refusal *why);

// Replaces the limits of the vehicle, for instance by a turn-rate factor estimated in flight.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`; then the limits stay as they
// were.
fga_status fga_avoider_set_vehicle(struct fga_avoider *avoider,
                                   const struct fga_vehicle *vehicle,
                                   struct fga_refusal *why);

// Sets limits for cases without a certified manoeuvre under the normal ones, for instance a steeper bank; null for none.
//
// Refuses `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`; then the limits stay as they were.
fga_status fga_avoider_set_vehicle_in_need(struct fga_avoider *avoider,
                                           const struct fga_vehicle *vehicle,
                                           struct fga_refusal *why);

// Forgets the flight: the next step is the first of another one. Settings, mission and counts stay; the limits of the vehicle
// are those of the construction again, without limits in need.
//
// Refuses `NULL`, `MISALIGNED`, `NOT_INITIALIZED`, `BUSY`.
fga_status fga_avoider_restart(struct fga_avoider *avoider);

// Decides what to fly until the next step. Call it once each decision period, with the state of that moment.
//
// `FGA_STATUS_INCOMPLETE`: the decision is made without some obstacles, which it counts. Obstacles with an unusable number, or at rest
// with a velocity known exactly, have no effect, and `why` names the first of them; of more obstacles than there is room for, those
// count that the aircraft could meet first.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE` (of time, ownship, wind, zones and
// ground), `UNKNOWN_VALUE`, `TOO_MANY` (more than `FGA_CAPACITY_MOST` obstacles or `FGA_ZONES_MOST` zones); then the avoider has not decided, and `decision` stays as it was.
fga_status fga_avoider_step(struct fga_avoider *avoider,
                            const struct fga_situation *situation,
                            struct fga_decision *decision,
                            struct fga_refusal *why);

// Decides like `fga_avoider_step`, among aircraft by expected cost: what the reports that `beliefs` has heard say that they may do, and what
// that costs. Obstacles of the situation that are aircraft count as reports of this moment too. The same beliefs go with the same avoider, which
// needs room for the believed aircraft beside other obstacles. Chances and `proven_share` are those of the last choice, up to 0.95 s ago. A choice
// weighs the six aircraft that may come nearest; `work_limit` does not bound it.
//
// `FGA_STATUS_INCOMPLETE` also where believed aircraft are left out for want of room; `work_limit_met` then too, and where more than six are around.
//
// Refuses what `fga_avoider_step` refuses, of either object.
fga_status fga_avoider_step_on_beliefs(struct fga_avoider *avoider,
                                       struct fga_beliefs *beliefs,
                                       const struct fga_situation *situation,
                                       struct fga_decision *decision,
                                       struct fga_refusal *why);

// What the avoider has done and refused since it was initialized.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`.
fga_status fga_avoider_counts(struct fga_avoider *avoider, struct fga_counts *counts);

// Bytes of storage for beliefs: `FGA_BELIEFS_BYTES`.
size_t fga_beliefs_size(void);

// Constructs beliefs about nobody in storage of the caller, as `fga_avoider_init` does an avoider. It takes up to 51 kB of stack, once; a step on
// beliefs takes 32 kB.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `WRONG_VERSION`, `STORAGE_TOO_SMALL`, `ALIASED`.
fga_status fga_beliefs_init(void *storage,
                            size_t storage_size,
                            uint32_t abi_version,
                            struct fga_beliefs **beliefs,
                            struct fga_refusal *why);

// Takes a report of an aircraft. `radius_m` and `half_height_m` are the volume around it; a half height of 0 means a sphere. Reports, situations
// and `now_s` share one clock. `own_m` is the ownship's position, metres.
//
// It counts each report. One that is late, or older than 8 s, changes nothing else. An aircraft without a report for 8 s is forgotten, unless the
// situation has it. What rests or flies straight by contract is an obstacle of the situation; it takes the place of an aircraft with its
// identifier.
//
// `FGA_STATUS_INCOMPLETE`: of more than 16 aircraft the farthest one is left out.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`, `UNKNOWN_VALUE`.
fga_status fga_beliefs_hear(struct fga_beliefs *beliefs,
                            const struct fga_report *report,
                            double radius_m,
                            double half_height_m,
                            double now_s,
                            struct fga_enu own_m,
                            struct fga_refusal *why);

// Forgets what was chosen, as at the begin of another flight; who is around stays known. Call it where `fga_avoider_restart` is called.
//
// Refuses `NULL`, `MISALIGNED`, `NOT_INITIALIZED`, `BUSY`.
fga_status fga_beliefs_restart(struct fga_beliefs *beliefs);

// What became of the reports since it was initialized.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`.
fga_status fga_beliefs_counts(struct fga_beliefs *beliefs, struct fga_report_counts *counts);

// The name of an `fga_state`, for logs; never null, and valid for ever.
const char *fga_state_text(uint32_t state);

// The sentence of an `fga_reason`, for logs; never null, and valid for ever.
const char *fga_reason_text(uint32_t reason);

// Bytes of storage for a learner: `FGA_LEARNED_BYTES`.
size_t fga_learned_size(void);

// Alignment of the storage of a learner, bytes: `FGA_ALIGN`.
size_t fga_learned_align(void);

// Constructs a learner in storage of the caller, as `fga_avoider_init` does an avoider. To forget all that was learned, construct it again.
//
// `vehicle` is what is believed before the flight: its turn-rate factor within 25 %, its bank time constant within 0.3 s and its dead time
// within 0.1 s. The wind is believed to be none, within 15 m/s to the east and to the north.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `WRONG_VERSION`, `STORAGE_TOO_SMALL`, `ALIASED`, `OUT_OF_RANGE`.
fga_status fga_learned_init(void *storage,
                            size_t storage_size,
                            uint32_t abi_version,
                            const struct fga_vehicle *vehicle,
                            struct fga_learned **learned,
                            struct fga_refusal *why);

// Learns from a state of the aircraft: call it 3 to 50 times a second, whoever flies. Steady turns show the turn-rate factor, commanded
// banks show lag and dead time, and velocities in several directions the wind; straight flight shows nothing.
//
// A state less than 0.015 s after the last one adds nothing, and one that comes late by up to a second is refused. Where the clock was
// set, or nothing came for 0.35 s, what was learned stays, and the commands before are not counted.
//
// An aircraft that turns unlike before by more than chance, or whose airspeed has changed by 15 %, is another one: a tenth of the evidence
// stays.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`, `UNKNOWN_VALUE`.
fga_status fga_learned_see(struct fga_learned *learned,
                           const struct fga_seen_state *state,
                           struct fga_refusal *why);

// What is known now, from what is believed beforehand and the flight.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`.
fga_status fga_learned_known(struct fga_learned *learned, struct fga_known_aircraft *known);

// The vehicle for decisions and proofs: the one of `fga_learned_init` with its response as it is known now, and 0.97 of the expected
// turn-rate factor, so that a turn may be a little wider than expected. `fga fly` plans with the same.
//
// Give it to `fga_avoider_set_vehicle` between manoeuvres, in `FGA_STATE_CRUISE`: a manoeuvre keeps the limits that it was proven with.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, and `OUT_OF_RANGE` where the bank lags more than a
// proof allows.
fga_status fga_learned_vehicle(struct fga_learned *learned,
                               struct fga_vehicle *vehicle,
                               struct fga_refusal *why);

// Keeps a tenth of the evidence of turns and rolls: the aircraft has become another one, by its load, its flaps or a failure.
//
// Refuses `NULL`, `MISALIGNED`, `NOT_INITIALIZED`, `BUSY`.
fga_status fga_learned_forget(struct fga_learned *learned);

// Bytes of storage for a prover: `FGA_PROVER_BYTES`.
size_t fga_prover_size(void);

// Alignment of the storage of a prover, bytes: `FGA_ALIGN`.
size_t fga_prover_align(void);

// Constructs a prover of manoeuvres of a vehicle in storage of the caller, as `fga_avoider_init` does an avoider. To change the
// vehicle, construct it again.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `WRONG_VERSION`, `STORAGE_TOO_SMALL`, `ALIASED`, `OUT_OF_RANGE`.
fga_status fga_prover_init(void *storage,
                           size_t storage_size,
                           uint32_t abi_version,
                           const struct fga_vehicle *vehicle,
                           struct fga_prover **prover,
                           struct fga_refusal *why);

// Proves that a manoeuvre, of whatever origin, keeps a separation from every obstacle of a situation, in continuous time: the
// aircraft flies the stages, with the response of the prover's vehicle, and each obstacle keeps its velocity or its place.
//
// It keeps the same separation from every zone, on the side that is allowed, and above the ground with its error and clearance. Where
// the aircraft begins on the wrong side of a zone, or more edges are within its reach than there is room for, nothing is proven.
//
// The proof covers neither turns of aircraft, which `straight_aircraft` counts, nor limits of altitude. With no stages the
// manoeuvre holds course and climb angle.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`, `UNKNOWN_VALUE`, `TOO_MANY`: no
// obstacle and no zone is left out.
fga_status fga_certify(struct fga_prover *prover,
                       const struct fga_situation *situation,
                       const struct fga_stage *stages,
                       uint32_t stage_count,
                       const struct fga_question *question,
                       struct fga_certificate *certificate,
                       struct fga_refusal *why);

// Where the aircraft is after some time on a manoeuvre, over the ground, with the response of the prover's vehicle. A vehicle
// with a dead time needs it: a step is asked about the moment at which its command begins to have an effect.
//
// The command of an earlier decision is flown on with its age taken from each `start_s`: of the stages that have begun, at 0 or below,
// the last one counts.
//
// `then` may not be `ownship`. Refuses `NULL`, `MISALIGNED`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE` (`after_s`: 0
// to 600), `TOO_MANY`.
fga_status fga_predict(struct fga_prover *prover,
                       const struct fga_ownship *ownship,
                       const struct fga_stage *stages,
                       uint32_t stage_count,
                       struct fga_enu wind_mps,
                       double after_s,
                       struct fga_ownship *then,
                       struct fga_refusal *why);

// Bytes of storage for the reports of this number of aircraft; 0 where it is above `FGA_CAPACITY_MOST`. For static storage the macro
// `FGA_REPORTS_BYTES` gives the same.
size_t fga_reports_size(uint32_t aircraft_most);

// Fills the standard deviations of a report by the `NACp` and `NACv` that ADS-B states (RTCA DO-260B; 14 CFR 91.217 for the altitude). A
// category without a bound counts as the worst with one.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`.
fga_status fga_report_set_adsb(struct fga_report *report,
                               uint8_t nac_p,
                               uint8_t nac_v);

// Constructs a filter of reports in storage of the caller, as `fga_avoider_init` does an avoider. An aircraft that is heard no more is
// forgotten after `lifetime_s`, above 0, to 600 seconds; what rests is not.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `WRONG_VERSION`, `STORAGE_TOO_SMALL`, `ALIASED`, `OUT_OF_RANGE`, `TOO_MANY`.
fga_status fga_reports_init(void *storage,
                            size_t storage_size,
                            uint32_t abi_version,
                            uint32_t aircraft_most,
                            double lifetime_s,
                            struct fga_reports **reports,
                            struct fga_refusal *why);

// Takes a report now, with the own aircraft at `own_m`; `now_s` is in seconds on the clock of the reports. It counts each report. A late
// one changes nothing else.
//
// The filter is the interacting multiple model filter of `fga-belief`: it weighs steady flight, wavering and turns by how well each
// foretold the report, and so knows a velocity better than a noisy report says it, or without one in the report.
//
// `FGA_STATUS_INCOMPLETE`: there is no room; of all aircraft the farthest one is left out.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`, `UNKNOWN_VALUE`.
fga_status fga_reports_hear(struct fga_reports *reports,
                            const struct fga_report *report,
                            double now_s,
                            struct fga_enu own_m,
                            struct fga_refusal *why);

// The obstacles of a moment, for a step: each aircraft carried on by the age of its last report, with the same volume around each, of
// `half_height_m` 0 for a sphere. Forgets who is heard no more.
//
// Refuses `NULL`, `MISALIGNED`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`, `OUT_OF_RANGE`, and `TOO_MANY` where `obstacle_most` is below the
// number of aircraft.
fga_status fga_reports_obstacles(struct fga_reports *reports,
                                 double now_s,
                                 double radius_m,
                                 double half_height_m,
                                 struct fga_obstacle *obstacles,
                                 uint32_t obstacle_most,
                                 uint32_t *obstacle_count,
                                 struct fga_refusal *why);

// What became of the reports since it was initialized.
//
// Refuses `NULL`, `MISALIGNED`, `WRONG_SIZE`, `ALIASED`, `NOT_INITIALIZED`, `BUSY`.
fga_status fga_reports_counts(struct fga_reports *reports, struct fga_report_counts *counts);

// The sentence of a status, for logs; never null, and valid for ever.
const char *fga_status_text(uint32_t status);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FGA_H */
