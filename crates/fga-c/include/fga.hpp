// fga for C++17: the C interface with storage, sizes and versions taken care of. Header only; no exceptions, no allocation.
//
// Frame, units, threads and answers are those of fga.h. Objects are constructed where they lie and cannot be copied or moved:
// make them static, or members of what is.

#ifndef FGA_HPP
#define FGA_HPP

#include "fga.h"

#include <cstddef>
#include <cstdint>
#include <limits>

namespace fga {

// A structure of fga.h with its size set and all else 0: fga::sized<fga_situation>().
template <typename Structure>
[[nodiscard]] constexpr Structure sized() noexcept {
  Structure structure{};
  structure.size = static_cast<std::uint32_t>(sizeof(Structure));
  return structure;
}

// Whether a call came with a result; FGA_STATUS_INCOMPLETE is one without some obstacles.
[[nodiscard]] constexpr bool has_result(fga_status status) noexcept {
  return status == FGA_STATUS_OK || status == FGA_STATUS_INCOMPLETE;
}

[[nodiscard]] inline const char *text(fga_status status) noexcept { return fga_status_text(status); }
[[nodiscard]] inline const char *text(fga_state state) noexcept { return fga_state_text(state); }
[[nodiscard]] inline const char *text(fga_reason reason) noexcept { return fga_reason_text(reason); }

// The default settings.
[[nodiscard]] inline fga_settings default_settings() noexcept {
  auto settings = sized<fga_settings>();
  (void)fga_settings_default(&settings);
  return settings;
}

// The stage of a command that has begun `after_s` seconds after its decision; null means: hold course and climb angle.
[[nodiscard]] inline const fga_stage *stage_at(const fga_decision &decision, double after_s) noexcept {
  const fga_stage *begun = nullptr;
  for (std::uint32_t k = 0; k < decision.stage_count && decision.stages[k].start_s <= after_s; ++k) {
    begun = &decision.stages[k];
  }
  return begun;
}

// An avoider with room for these numbers of obstacles a step and waypoints.
template <std::uint32_t Obstacles, std::uint32_t Waypoints>
class Avoider {
 public:
  Avoider() noexcept = default;
  Avoider(const Avoider &) = delete;
  Avoider &operator=(const Avoider &) = delete;

  // Constructs it, or constructs it again; before, every call answers FGA_STATUS_NULL.
  [[nodiscard]] fga_status init(const fga_settings &settings, const fga_vehicle &vehicle) noexcept {
    avoider_ = nullptr;
    return fga_avoider_init(storage_, sizeof storage_, FGA_ABI_VERSION, Obstacles, Waypoints, &settings, &vehicle,
                            &avoider_, &why_);
  }

  // Flies from each waypoint to the next, between two altitudes.
  [[nodiscard]] fga_status set_mission(const fga_waypoint *waypoints, std::uint32_t count,
                                       double floor_m = -std::numeric_limits<double>::infinity(),
                                       double ceiling_m = std::numeric_limits<double>::infinity()) noexcept {
    auto mission = sized<fga_mission>();
    mission.waypoint_count = count;
    mission.waypoints = waypoints;
    mission.floor_m = floor_m;
    mission.ceiling_m = ceiling_m;
    return fga_avoider_set_mission(avoider_, &mission, &why_);
  }

  [[nodiscard]] fga_status set_vehicle(const fga_vehicle &vehicle) noexcept {
    return fga_avoider_set_vehicle(avoider_, &vehicle, &why_);
  }

  // Limits for cases without a certified manoeuvre under the normal ones; null for none.
  [[nodiscard]] fga_status set_vehicle_in_need(const fga_vehicle *vehicle) noexcept {
    return fga_avoider_set_vehicle_in_need(avoider_, vehicle, &why_);
  }

  [[nodiscard]] fga_status restart() noexcept { return fga_avoider_restart(avoider_); }

  // Decides what to fly until the next step.
  [[nodiscard]] fga_status step(const fga_situation &situation, fga_decision &decision) noexcept {
    return fga_avoider_step(avoider_, &situation, &decision, &why_);
  }

  // The same on beliefs, see `Beliefs`.
  [[nodiscard]] fga_status step(fga_beliefs *beliefs, const fga_situation &situation, fga_decision &decision) noexcept {
    return fga_avoider_step_on_beliefs(avoider_, beliefs, &situation, &decision, &why_);
  }

  [[nodiscard]] fga_status counts(fga_counts &counts) noexcept { return fga_avoider_counts(avoider_, &counts); }

  // What the last call refused, if it named a value.
  [[nodiscard]] const fga_refusal &why() const noexcept { return why_; }

 private:
  alignas(FGA_ALIGN) unsigned char storage_[FGA_AVOIDER_BYTES(Obstacles, Waypoints)];
  fga_avoider *avoider_ = nullptr;
  fga_refusal why_ = sized<fga_refusal>();
};

// Proves manoeuvres of one vehicle, and predicts where they lead.
class Prover {
 public:
  Prover() noexcept = default;
  Prover(const Prover &) = delete;
  Prover &operator=(const Prover &) = delete;

  [[nodiscard]] fga_status init(const fga_vehicle &vehicle) noexcept {
    prover_ = nullptr;
    return fga_prover_init(storage_, sizeof storage_, FGA_ABI_VERSION, &vehicle, &prover_, &why_);
  }

  [[nodiscard]] fga_status certify(const fga_situation &situation, const fga_stage *stages, std::uint32_t count,
                                   const fga_question &question, fga_certificate &certificate) noexcept {
    return fga_certify(prover_, &situation, stages, count, &question, &certificate, &why_);
  }

  [[nodiscard]] fga_status predict(const fga_ownship &ownship, const fga_stage *stages, std::uint32_t count,
                                   fga_enu wind_mps, double after_s, fga_ownship &then) noexcept {
    return fga_predict(prover_, &ownship, stages, count, wind_mps, after_s, &then, &why_);
  }

  [[nodiscard]] const fga_refusal &why() const noexcept { return why_; }

 private:
  alignas(FGA_ALIGN) unsigned char storage_[FGA_PROVER_BYTES];
  fga_prover *prover_ = nullptr;
  fga_refusal why_ = sized<fga_refusal>();
};

// Learns from the flight how the aircraft follows its commands, and the wind.
class Learned {
 public:
  Learned() noexcept = default;
  Learned(const Learned &) = delete;
  Learned &operator=(const Learned &) = delete;

  // Constructs it from what is believed before the flight, or constructs it again and so forgets all.
  [[nodiscard]] fga_status init(const fga_vehicle &vehicle) noexcept {
    learned_ = nullptr;
    return fga_learned_init(storage_, sizeof storage_, FGA_ABI_VERSION, &vehicle, &learned_, &why_);
  }

  [[nodiscard]] fga_status see(const fga_seen_state &state) noexcept { return fga_learned_see(learned_, &state, &why_); }

  [[nodiscard]] fga_status known(fga_known_aircraft &known) noexcept { return fga_learned_known(learned_, &known); }

  // The vehicle for decisions and proofs; give it to an avoider in FGA_STATE_CRUISE.
  [[nodiscard]] fga_status vehicle(fga_vehicle &vehicle) noexcept { return fga_learned_vehicle(learned_, &vehicle, &why_); }

  [[nodiscard]] fga_status forget() noexcept { return fga_learned_forget(learned_); }

  // The learner as fga_task_settings takes it; null before it is constructed.
  [[nodiscard]] fga_learned *get() noexcept { return learned_; }

  [[nodiscard]] const fga_refusal &why() const noexcept { return why_; }

 private:
  alignas(FGA_ALIGN) unsigned char storage_[FGA_LEARNED_BYTES];
  fga_learned *learned_ = nullptr;
  fga_refusal why_ = sized<fga_refusal>();
};

// The obstacles of a step by raw reports of at most this number of aircraft.
template <std::uint32_t Aircraft>
class Reports {
 public:
  Reports() noexcept = default;
  Reports(const Reports &) = delete;
  Reports &operator=(const Reports &) = delete;

  // Constructs it without aircraft, each of which is forgotten after a lifetime without a report, or constructs it again.
  [[nodiscard]] fga_status init(double lifetime_s) noexcept {
    reports_ = nullptr;
    return fga_reports_init(storage_, sizeof storage_, FGA_ABI_VERSION, Aircraft, lifetime_s, &reports_, &why_);
  }

  [[nodiscard]] fga_status hear(const fga_report &report, double now_s, fga_enu own_m) noexcept {
    return fga_reports_hear(reports_, &report, now_s, own_m, &why_);
  }

  // Gives a situation the obstacles of its time, which lie here, with the same volume around each.
  [[nodiscard]] fga_status obstacles(double radius_m, double half_height_m, fga_situation &situation) noexcept {
    situation.obstacles = obstacles_;
    return fga_reports_obstacles(reports_, situation.time_s, radius_m, half_height_m, obstacles_, Aircraft,
                                 &situation.obstacle_count, &why_);
  }

  [[nodiscard]] fga_status counts(fga_report_counts &counts) noexcept { return fga_reports_counts(reports_, &counts); }

  [[nodiscard]] const fga_refusal &why() const noexcept { return why_; }

 private:
  alignas(FGA_ALIGN) unsigned char storage_[FGA_REPORTS_BYTES(Aircraft)];
  fga_obstacle obstacles_[Aircraft];
  fga_reports *reports_ = nullptr;
  fga_refusal why_ = sized<fga_refusal>();
};

// Beliefs about aircraft by their raw reports, on which an avoider decides by expected cost.
class Beliefs {
 public:
  Beliefs() noexcept = default;
  Beliefs(const Beliefs &) = delete;
  Beliefs &operator=(const Beliefs &) = delete;

  // Constructs them about nobody, or constructs them again and so forgets all.
  [[nodiscard]] fga_status init() noexcept {
    beliefs_ = nullptr;
    return fga_beliefs_init(storage_, sizeof storage_, FGA_ABI_VERSION, &beliefs_, &why_);
  }

  // Takes a report of an aircraft, with a volume around it.
  [[nodiscard]] fga_status hear(const fga_report &report, double radius_m, double half_height_m, double now_s,
                                fga_enu own_m) noexcept {
    return fga_beliefs_hear(beliefs_, &report, radius_m, half_height_m, now_s, own_m, &why_);
  }

  [[nodiscard]] fga_status restart() noexcept { return fga_beliefs_restart(beliefs_); }

  [[nodiscard]] fga_status counts(fga_report_counts &counts) noexcept { return fga_beliefs_counts(beliefs_, &counts); }

  // The beliefs as Avoider::step and fga_task_settings take them; null before they are constructed.
  [[nodiscard]] fga_beliefs *get() noexcept { return beliefs_; }

  [[nodiscard]] const fga_refusal &why() const noexcept { return why_; }

 private:
  alignas(FGA_ALIGN) unsigned char storage_[FGA_BELIEFS_BYTES];
  fga_beliefs *beliefs_ = nullptr;
  fga_refusal why_ = sized<fga_refusal>();
};

}  // namespace fga

#endif  // FGA_HPP
