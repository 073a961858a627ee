// An aircraft that turns by 0.7 of what its limits say is learned in C++, and planned with: prints the factor.
#include <cmath>
#include <cstdio>

#include "fga.hpp"

int main() {
  static fga::Learned learned;
  static fga::Avoider<1, 2> avoider;
  auto vehicle = fga::sized<fga_vehicle>();
  auto state = fga::sized<fga_seen_state>();
  if (learned.see(state) != FGA_STATUS_NULL || learned.get() || fga_vehicle_from_bank(25.0, 0.7, &vehicle, nullptr) ||
      learned.init(vehicle) || avoider.init(fga::default_settings(), vehicle)) {
    return 1;
  }
  for (int n = 0; n < 600; ++n) {
    state.time_s = 0.1 * n;
    state.airspeed_mps = 25.0;
    state.bank_left_rad = n / 50 % 2 ? 0.5 : -0.5;
    state.turn_rate_left_radps = 0.7 * 9.80665 * std::tan(state.bank_left_rad) / state.airspeed_mps;
    if (learned.see(state)) return 2;
  }
  auto known = fga::sized<fga_known_aircraft>();
  if (learned.known(known) || !(known.has & FGA_KNOWN_TURN_RATE) || learned.vehicle(vehicle) || avoider.set_vehicle(vehicle)) return 3;
  std::printf("%.1f\n", known.turn_rate_factor.mean);
  state.airspeed_mps = NAN;
  if (learned.see(state) != FGA_STATUS_OUT_OF_RANGE || !learned.why().field[0]) return 4;
  return learned.forget() != FGA_STATUS_OK;
}
