/// Quantities of a scene, ready to be evaluated in any of its states.
#pragma once

#include "discretization/quantities/end_layers.hpp"
#include "discretization/quantities/quantity.hpp"
#include "discretization/quantities/quantity_derivative.hpp"
#include "discretization/quantities/quantity_kind.hpp"
#include "discretization/state/sampling.hpp"
#include "discretization/text/expression.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mixbeam {

/// Name of a number in formulas: "tip load (2)" -> "tip_load__2_".
std::string name_in_formulas(std::string name);

/// A state, and data already known of it.
struct QuantityState {
  const Model& model;
  const State& state;
  double load_factor = 0.0;
  const std::vector<RecordedReaction>& reactions;  ///< of the model's supports, in their order
  StrainEnergy energy{};
  int negative = -1;  ///< eigenvalues below zero; -1: not counted
  int jumps = 0;      ///< of the path so far
  /// Samples of all members of this rank, for extremes; null: none.
  const SampledMembers* samples = nullptr;
  /// Offsets of the set's scene in a model of several scenes side by side (merged_scene.hpp).
  int first_member = 0;
  std::size_t first_support = 0;
  std::string prefix_of_points{};
  /// Layers for section forces and stresses at ends of members, and for extremes; forces are then by their spatial
  /// components, as for the state of a richer space. Null: neither.
  const std::vector<EndLayer>* layers = nullptr;
  /// omega / (2 pi) of a natural mode, NaN if unknown; null: none is known.
  std::function<double(int mode)> natural_frequency{};
  std::shared_ptr<StressedSections> stresses{};  ///< made by QuantitySet::values()
};

class QuantityPlaces;

class QuantitySet {
 public:
  QuantitySet();
  /// Throws InputError for names that the scene does not have, at the entry in `place`, the list of quantities.
  QuantitySet(const std::vector<Quantity>& quantities, const Scene& scene, const InputPlace& place);

  /// One number, in the order of the list: NAME; NAME.x, .y, .z or NAME.1, .2, .3 of a vector; NAME[PLACE] of each
  /// place that matches a pattern; with an extreme along members also NAME.member (index in the scene), NAME.arc_length
  /// and NAME.side (-1, 1: of the element before, after a vertex; 0: inside an element).
  struct Column {
    std::string name;
    std::size_t quantity = 0;  ///< in the list
    bool is_value = true;      ///< false: place of an extreme
    bool is_member = false;    ///< index of a member
    bool is_limited = false;   ///< its quantity has a limit, see asked()
  };
  const std::vector<Column>& columns() const { return columns_; }
  std::vector<std::string> names() const;
  /// Name of the quantity that a column belongs to.
  const std::string& name_of(const Column& column) const { return asked(column).name; }
  const Quantity& asked(const Column& column) const;
  /// Unit of every column, empty for none; `scene_units`: Scene::units, without which nothing is known.
  std::vector<std::string> units(const std::string& scene_units) const;
  bool empty() const { return columns_.empty(); }

  /// Value of every column. Collective.
  std::vector<double> values(const QuantityState& at) const;
  /// (column): place of the largest or smallest of several, "pier 2", "deck@50%"; empty for all others. Collective.
  std::vector<std::string> places(const QuantityState& at) const;
  /// (column): whether the quantity is taken in a layer of the state for which no closed form is known.
  std::vector<unsigned char> hidden_in_layers(const QuantityState& at) const;

  /// The set with extremes fixed at their places in a state of these values: smooth functions of state and scene.
  QuantitySet pinned(const QuantityState& at, const std::vector<double>& values) const;
  /// Derivative of a column of a pinned set with respect to the state, at the values of all columns there. Throws
  /// std::invalid_argument if it has none. One process only.
  StateDerivative derivative(std::size_t column, const QuantityState& at, const std::vector<double>& values) const;

 private:
  struct Resolved;
  void add_derivative(std::size_t column, double factor, const QuantityState& at, const std::vector<double>& values,
                      StateDerivative& sum) const;
  std::size_t first_column_of(std::size_t quantity) const;
  void resolve(const Quantity& quantity, std::size_t index, const Scene& scene, const QuantityPlaces& found,
               const InputPlace& place);
  void add_formula(const Quantity& quantity, std::size_t index, const InputPlace& place);
  void add_columns(const Quantity& quantity, std::size_t index, const std::string& place);

  std::vector<Column> columns_;
  std::shared_ptr<std::vector<Resolved>> resolved_;
};

}  // namespace mixbeam
