// An aircraft ahead is heard in C++, filtered and believed: prints the states that follow from both.
#include <cmath>
#include <cstdio>

#include "fga.hpp"

int main() {
  static fga::Reports<2> reports;
  static fga::Beliefs beliefs;
  static fga::Avoider<2, 2> by_worst_cases, by_cost;
  auto vehicle = fga::sized<fga_vehicle>();
  const fga_waypoint leg[] = {{{0, 0, 100}, FGA_PASSING_FLY_BY}, {{9000, 0, 100}, FGA_PASSING_FLY_BY}};
  auto report = fga::sized<fga_report>();
  const fga_enu own_m = {0, 0, 100};
  if (reports.hear(report, 0, own_m) != FGA_STATUS_NULL || beliefs.get() || fga_vehicle_from_bank(28.0, 0.6, &vehicle, nullptr) ||
      by_worst_cases.init(fga::default_settings(), vehicle) || by_cost.init(fga::default_settings(), vehicle) ||
      by_worst_cases.set_mission(leg, 2) || by_cost.set_mission(leg, 2) || reports.init(10.0) || beliefs.init()) {
    return 1;
  }
  report.id = 7;
  report.movement = FGA_MOVEMENT_CREWED;
  report.has_velocity = 1;
  report.position_m = {800, 0, 100};
  report.velocity_mps = {-40, 0, 0};
  if (fga_report_set_adsb(&report, 10, 3) || reports.hear(report, 0, own_m) || beliefs.hear(report, 150, 30, 0, own_m)) return 2;
  auto situation = fga::sized<fga_situation>();
  situation.ownship.position_m = own_m;
  situation.ownship.airspeed_mps = 28.0;
  auto first = fga::sized<fga_decision>(), second = fga::sized<fga_decision>();
  if (by_cost.step(beliefs.get(), situation, second)) return 3;
  if (reports.obstacles(150, 30, situation) || situation.obstacle_count != 1 || by_worst_cases.step(situation, first)) return 4;
  auto counts = fga::sized<fga_report_counts>();
  if (reports.counts(counts) || counts.heard != 1 || beliefs.counts(counts) || counts.heard != 1) return 5;
  std::printf("%s, %s\n", fga::text(static_cast<fga_state>(first.state)), fga::text(static_cast<fga_state>(second.state)));
  report.position_m.north = NAN;
  return reports.hear(report, 1, own_m) != FGA_STATUS_OUT_OF_RANGE || !reports.why().field[0];
}
