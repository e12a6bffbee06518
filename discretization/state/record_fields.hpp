/// Numbers, words and fields of results, each declared once: used to read and write result files, for summaries and
/// Python, and to list them in results.md.
#pragma once

#include "discretization/state/member_samples.hpp"

#include <tuple>
#include <type_traits>
#include <utility>

namespace mixbeam {

/// Storage of a field of a record.
enum class Kept {
  always,
  if_known,  ///< left out unless is_known_value(); unchanged if a file lacks it
  inside     ///< only inside the program
};

/// Field of a record. Its shape follows from its type: one number or word, or a vector per sample.
template <class Record, class Value>
struct Field {
  const char* name;  ///< in files and programs
  Value Record::*member;
  const char *unit, *meaning;  ///< "": dimensionless
  Kept kept;
  const char* in_summary;  ///< name there, if different
};

template <class Record, class Value>
constexpr Field<Record, Value> field(const char* name, Value Record::*member, const char* unit, const char* meaning,
                                     Kept kept = Kept::always, const char* in_summary = nullptr) {
  return {name, member, unit, meaning, kept, in_summary};
}

/// Field of summaries only, whose page explains it.
template <class Record, class Value>
constexpr Field<Record, Value> field(const char* name, Value Record::*member, Kept kept = Kept::always) {
  return {name, member, "", "", kept, nullptr};
}

/// Lists the fields of each kind of record as a tuple, in the order in which they are written.
template <class Record>
inline constexpr std::tuple<> kFields;

template <>
inline constexpr auto kFields<StepSummary> =
    std::tuple{field("step", &StepSummary::step, "", "number; 0 before any load"),
               field("load_factor", &StepSummary::load_factor, "", "may fall along a path past a limit point"),
               field("newton_iterations", &StepSummary::newton_iterations, "", "failed attempts included"),
               field("residual", &StepSummary::residual, "", "largest scaled row at the end"),
               field("strain_energy", &StepSummary::strain_energy, "force * length", "of the structure"),
               field("force_energy", &StepSummary::force_energy, "force * length", "of force strains"),
               field("moment_energy", &StepSummary::moment_energy, "force * length", "of moment strains")};

/// Numbers needed to continue a path; see also kFieldsAlongPath.
template <>
inline constexpr auto kFields<PathPoint> =
    std::tuple{field("step_size", &PathPoint::step_size, "", "as the control of step sizes gave it"),
               field("iterations", &PathPoint::iterations, "", "of the attempt that succeeded"),
               field("attempts_left", &PathPoint::attempts_left, "", "in the stage"),
               field("failed_steps", &PathPoint::failed_steps, "", "so far"),
               field("newton_iterations", &PathPoint::newton_iterations, "", "so far")};
inline constexpr auto kFieldsAlongPath =
    std::tuple{field("stage", &PathPoint::stage, "", "of the step"),
               field("critical_points", &PathPoint::critical_points, "", "passed so far"),
               field("path_length", &PathPoint::path_length, "", "of the step to come; 0: by load factor"),
               field("direction", &PathPoint::direction, "", "sign of the change of the load factor"),
               field("negative", &PathPoint::negative, "", "eigenvalues below zero; -1: not counted"),
               field("branched", &PathPoint::branched, "", "1: the path has left the primary one")};
/// Fields present only if loads have formulas.
inline constexpr auto kFieldsOfPiece =
    std::tuple{field("piece", &PathPoint::piece, "", "load factor at which the piece begins"),
               field("parameter", &PathPoint::parameter, "", "of the step in the piece")};

template <>
inline constexpr auto kFields<RecordedJump> = std::tuple{
    field("from", &RecordedJump::from, "", "load factor at which the stable path ends", Kept::always,
          "from_load_factor"),
    field("to", &RecordedJump::to, "", "load factor of the first state behind", Kept::always, "to_load_factor"),
    field("released", &RecordedJump::released, "force * length", "energy, theory (66)", Kept::always,
          "energy_released"),
    field("motion", &RecordedJump::motion, "", "mean, displacements over the length"),
    field("largest", &RecordedJump::largest, "length", "displacement of any vertex", Kept::always,
          "largest_displacement"),
    field("place", &RecordedJump::place, "", "of that vertex"),
    field("factorizations", &RecordedJump::factorizations, "", "that the search took")};

template <>
inline constexpr auto kFields<RecordedCriticalPoint> =
    std::tuple{field("kind", &RecordedCriticalPoint::kind, "", "limit point, bifurcation, flutter"),
               field("load_factor", &RecordedCriticalPoint::load_factor, "", "where it is"),
               field("negative_before", &RecordedCriticalPoint::negative_before, "",
                     "negative eigenvalues before; of flutter motions that grow"),
               field("negative_after", &RecordedCriticalPoint::negative_after, "", "negative eigenvalues behind"),
               field("modes", &RecordedCriticalPoint::modes, "", "that become singular, or meet, together"),
               field("omega", &RecordedCriticalPoint::omega, "radian / time", "of flutter", Kept::if_known),
               field("load_factor_error", &RecordedCriticalPoint::load_factor_error, "", "estimated", Kept::if_known),
               field("position", &RecordedCriticalPoint::position, "length", "spatial"),
               field("displacement", &RecordedCriticalPoint::displacement, "length", "spatial"),
               field("mode", &RecordedCriticalPoint::mode, "", "displacement of the critical mode, spatial")};

template <>
inline constexpr auto kFields<RecordedBucklingMode> =
    std::tuple{field("load_factor", &RecordedBucklingMode::load_factor, "", "negative: under the reversed load"),
               field("residual", &RecordedBucklingMode::residual, "", "share that may be wrong"),
               field("confirmed", &RecordedBucklingMode::confirmed, "", "1: by the inertia on both sides"),
               field("error", &RecordedBucklingMode::error, "", "of the mesh, estimated", Kept::if_known),
               field("mode", &RecordedBucklingMode::mode, "", "displacement of the mode, spatial")};

template <>
inline constexpr auto kFields<RecordedVibrationMode> = std::tuple{
    field("track", &RecordedVibrationMode::track, "", "number of its motion over the path", Kept::if_known),
    field("eigenvalue", &RecordedVibrationMode::eigenvalue, "1 / time^2", "omega^2; negative: the state is not stable"),
    field("omega", &RecordedVibrationMode::omega, "radian / time", "zero where omega^2 is negative"),
    field("frequency", &RecordedVibrationMode::frequency, "1 / time", "omega / (2 pi): Hz where seconds are the unit"),
    field("growth", &RecordedVibrationMode::growth, "1 / time",
          "a disturbance grows as exp(growth t); negative: it decays so", Kept::if_known),
    field("modal_mass", &RecordedVibrationMode::modal_mass, "mass",
          "twice the kinetic energy of the mode at unit rate"),
    field("participation_x", &RecordedVibrationMode::participation_x, "",
          "momentum along x over the modal mass; its square times that mass takes part"),
    field("participation_y", &RecordedVibrationMode::participation_y, "", "likewise along y"),
    field("participation_z", &RecordedVibrationMode::participation_z, "", "likewise along z"),
    field("residual", &RecordedVibrationMode::residual, "", "of the pair"),
    field("confirmed", &RecordedVibrationMode::confirmed, "", "1: the inertia tells that none below is missing"),
    field("mode", &RecordedVibrationMode::mode, "", "displacement of the mode, spatial")};

template <>
inline constexpr auto kFields<RecordedStability> =
    std::tuple{field("stable", &RecordedStability::stable, Kept::if_known),
               field("stable_held", &RecordedStability::held, Kept::if_known),
               field("negative_eigenvalues", &RecordedStability::negative, Kept::if_known)};

/// Errors of the whole structure.
inline constexpr std::pair<const char*, RecordedError ErrorSummary::*> kErrorsOfEstimate[] = {
    {"largest_displacement", &ErrorSummary::largest_displacement},
    {"displacement", &ErrorSummary::displacement},
    {"moment", &ErrorSummary::moment},
    {"energy", &ErrorSummary::energy}};

template <class Record, class Fields, class Visit>
void visit_fields(Record& record, const Fields& fields, const Visit& visit) {
  std::apply([&](const auto&... field) { (visit(field, record.*field.member), ...); }, fields);
}
/// Calls visit(field, its value) for each field of a record.
template <class Record, class Visit>
void visit_fields(Record& record, const Visit& visit) {
  visit_fields(record, kFields<std::remove_const_t<Record>>, visit);
}

/// Unknown counts are negative.
inline bool is_known_value(double value) { return !std::isnan(value); }
inline bool is_known_value(int value) { return value >= 0; }
template <class Value>
bool is_known_value(const Value& value) {
  if constexpr (std::is_enum_v<Value> || std::is_same_v<Value, bool>)
    return true;
  else
    return !value.empty();
}
template <class Value>
inline constexpr bool kIsAtSamples = std::is_same_v<std::decay_t<Value>, std::vector<Vector3>>;

}  // namespace mixbeam
