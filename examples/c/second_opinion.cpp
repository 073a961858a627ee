// A second opinion in C++: fga proves or refutes manoeuvres that somebody else has chosen.
//
// A mast stands 150 m ahead. Three ways past it are judged: straight on, a turn of 10 degrees, a turn of 40 degrees. Then fga
// chooses one of its own, and judges that too.
//
// c++ -std=c++17 second_opinion.cpp -I PREFIX/include -L PREFIX/lib -lfga_c

#include "fga.hpp"

#include <cstdio>

namespace {

constexpr double DEGREE = 3.14159265358979323846 / 180.0;

fga::Prover prover;
fga::Avoider<4, 2> avoider;

int refused(const char *call, fga_status status, const fga_refusal &why) {
  if (fga::has_result(status)) {
    return 0;
  }
  std::fprintf(stderr, "%s: %s (%s is %g, expected %s)\n", call, fga::text(status), why.field, why.value, why.expected);
  return 1;
}

// Judges a manoeuvre: whether 0.05 m beyond every volume is proven for 60 s.
fga_verdict judge(const char *name, const fga_situation &situation, const fga_stage *stages, std::uint32_t count) {
  auto question = fga::sized<fga_question>();
  question.work_limit = 20000;
  question.horizon_s = 60.0;
  question.target_m = 0.05;
  auto certificate = fga::sized<fga_certificate>();
  if (refused("certify", prover.certify(situation, stages, count, question, certificate), prover.why())) {
    return FGA_VERDICT_LIMIT_MET;
  }
  if (certificate.verdict == FGA_VERDICT_PROVEN) {
    std::printf("%-16s proven: at least %.2f m beyond every volume\n", name, certificate.margin_m);
  } else if (certificate.obstacle_id == 0) {
    std::printf("%-16s not proven: %.1f m from the zone after %.1f s\n", name, certificate.margin_m, certificate.at_s);
  } else {
    std::printf("%-16s not proven: %.1f m from the volume of obstacle %u after %.1f s\n", name, certificate.margin_m,
                static_cast<unsigned>(certificate.obstacle_id), certificate.at_s);
  }
  return certificate.verdict;
}

}  // namespace

int main() {
  // 18 m/s, banks of up to 40 degrees that follow with a time constant of 0.5 s.
  auto vehicle = fga::sized<fga_vehicle>();
  auto why = fga::sized<fga_refusal>();
  if (refused("vehicle", fga_vehicle_from_bank(18.0, 40.0 * DEGREE, &vehicle, &why), why)) {
    return 1;
  }
  vehicle.bank_time_constant_s = 0.5;
  const fga_waypoint leg[] = {{{0.0, 0.0, 100.0}, FGA_PASSING_FLY_BY}, {{1000.0, 0.0, 100.0}, FGA_PASSING_FLY_BY}};
  if (refused("prover", prover.init(vehicle), prover.why()) ||
      refused("avoider", avoider.init(fga::default_settings(), vehicle), avoider.why()) ||
      refused("mission", avoider.set_mission(leg, 2), avoider.why())) {
    return 1;
  }

  auto mast = fga::sized<fga_obstacle>();
  mast.id = 7;
  mast.position_m = {150.0, 5.0, 100.0};
  mast.volume = FGA_VOLUME_CYLINDER;
  mast.radius_m = 30.0;
  mast.half_height_m = 120.0;
  mast.movement = FGA_MOVEMENT_AT_REST;
  auto situation = fga::sized<fga_situation>();
  situation.obstacles = &mast;
  situation.obstacle_count = 1;
  situation.ownship.position_m = leg[0].position_m;
  situation.ownship.airspeed_mps = 18.0;

  const fga_stage slight[] = {{0.0, -10.0 * DEGREE, 0.0, 1.0}};
  const fga_stage clear[] = {{0.0, -40.0 * DEGREE, 0.0, 1.0}};
  const bool straight_on = judge("straight on", situation, nullptr, 0) == FGA_VERDICT_PROVEN;
  const bool slightly = judge("10 degrees right", situation, slight, 1) == FGA_VERDICT_PROVEN;
  const bool clearly = judge("40 degrees right", situation, clear, 1) == FGA_VERDICT_PROVEN;

  auto decision = fga::sized<fga_decision>();
  if (refused("step", avoider.step(situation, decision), avoider.why())) {
    return 1;
  }
  std::printf("fga: %s, %s\n", fga::text(decision.state), fga::text(decision.reason));
  const bool own = judge("fga's own", situation, decision.stages, decision.stage_count) == FGA_VERDICT_PROVEN;

  // A village on the right, to keep out of.
  const fga_place corners[] = {{60.0, -15.0}, {900.0, -15.0}, {900.0, -400.0}, {60.0, -400.0}};
  fga_zone village{};
  village.kind = FGA_ZONE_KIND_KEEP_OUT;
  village.corners = corners;
  village.corner_count = 4;
  village.floor_m = -std::numeric_limits<double>::infinity();
  village.ceiling_m = 300.0;
  situation.zones = &village;
  situation.zone_count = 1;
  const bool over_it = judge("over the village", situation, clear, 1) == FGA_VERDICT_PROVEN;
  if (refused("restart", avoider.restart(), avoider.why()) ||
      refused("step", avoider.step(situation, decision), avoider.why())) {
    return 1;
  }
  const bool beside_it = judge("fga's other one", situation, decision.stages, decision.stage_count) == FGA_VERDICT_PROVEN;
  return !straight_on && !slightly && clearly && own && !over_it && beside_it ? 0 : 1;
}
