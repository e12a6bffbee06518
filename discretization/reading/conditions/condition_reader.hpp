/// The work behind read_conditions (reading/scene_parts.hpp).
#pragma once

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/parameters/access.hpp"
#include "discretization/parameters/binding.hpp"
#include "discretization/reading/scene_parts.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/scene/what_acts.hpp"
#include "discretization/text/formula.hpp"
#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <set>
#include <unordered_map>
#include <utility>

namespace mixbeam {

/// What follows the name of a point or member that may stand for many.
inline const std::string kWildcard = "; " + kWildcards + ", and every match is meant.";

/// Stage, amplitude and case of whatever acts.
template <class Acting>
void bind_schedule(BoundList<Acting>& list, const std::string& what) {
  constexpr int kMostStages = 1000;
  list.bind(&Acting::stage, integer("Stage").at_least(1).at_most(kMostStages).by_default(),
            what +
                " from zero to full while the load factor goes from stage - 1 to stage, and stays after that; with an "
                "amplitude: the load factor runs at least up to this number.");
  list.bind(&Acting::amplitude, text("Amplitude").or_other("a formula"),
            "Factor of all components as a formula of t = load factor and stage = Stage, like sin(pi*t); instead of "
            "the growth in one stage.");
  list.bind(&Acting::load_case, text("Case"),
            "Load case, one of \"Load Cases\", in which alone it acts; in all of them if absent.");
}

/// An eigenstrain as it was written.
struct EigenstrainDraft : Eigenstrain {
  std::optional<double> temperature{}, expansion_coefficient{};
  std::string strain_file{}, curvature_file{};
  Vector3 start_turn{}, end_turn{};
};

/// The list "Gravity".
ListSpec gravity_spec();
/// The list "Rotating Frame".
ListSpec rotating_frame_spec();
/// Adds the lists of all other loads.
void add_load_lists(ListSpec& spec);

/// One pass over what acts on a scene whose points and members are complete.
class ConditionReader {
 public:
  /// `copies`: those of patterns that take along what acts.
  ConditionReader(const Teuchos::ParameterList& scene_list, const InputPlace& place, Scene& scene,
                  const std::vector<CopiedPattern>& copies)
      : scene_list_(scene_list), place_(place), scene_(scene), copies_(copies), names_(scene) {}

  /// Tells what was left out where patterns end, and why.
  std::vector<std::string> read();

 private:
  using List = Teuchos::ParameterList;

  /// A use of a stage: what acts with an amplitude acts in every stage up to its own.
  struct UsedStage {
    Stage first = 1, last = 1;
    std::string load_case;
    InputPlace place;
  };

  /// Calls `action` with name, list and place of each list inside the list `lists`.
  template <class Action>
  void for_each(const std::string& lists, const Action& action) const {
    const List& all = scene_list_.sublist(lists);
    for (const std::string& name : names_of(all)) {
      const InputPlace place = place_[lists][name];
      place.attempt([&] { action(name, all.sublist(name), place); });
    }
  }

  void read_load_cases();
  void read_combinations();
  void read_supports();
  void read_joints();
  void read_loads();
  /// Reads a list of loads at points, one or more of the parameters `needed` in each.
  template <class Load, class Complete>
  void read_at_points(const BoundList<Load>& parameters, const std::vector<std::string>& needed,
                      const Complete& complete);
  void read_point_masses();
  void read_distributed_loads();
  void check_part(const DistributedLoad& load, const List& list, const InputPlace& place) const;
  void divide_at(const std::string& member, const std::array<double, 2>& range, const InputPlace& place);
  void read_gravity();
  void read_weight(const List& list, const InputPlace& place);
  void read_rotating_frame();
  void read_eigenstrains();

  /// Adds one of the kinds of scene/what_acts.hpp.
  template <class Acting>
  void add(const Acting& one, const std::string& entry) {
    (scene_.*ActingKind<Acting>::list).push_back(one);
    entries_[ActingKind<Acting>::name].push_back(entry);
  }
  template <class Acting>
  void copy_with_patterns();
  void note_left_out(const std::string& list, const std::string& entry, const std::string& point,
                     const std::string& why);
  void copy_supports();
  void copy_joints();
  void copy_loads();
  /// Completes a copy; false: it has no members there.
  template <class Acting>
  bool goes_along(const Acting&, const PatternCopy&, const std::string&) {
    return true;
  }
  bool goes_along(Support& copy, const PatternCopy& made, const std::string& entry);
  bool goes_along(PointLoad& copy, const PatternCopy& made, const std::string& entry);
  bool goes_along(DistributedLoad& copy, const PatternCopy& made, const std::string& entry);
  bool goes_along(Eigenstrain& copy, const PatternCopy& made, const std::string& entry);

  Support read_support(const List& list, const InputPlace& place);
  void claim_support(const std::string& point, const std::string& name, const InputPlace& place);
  void check_support(const Support& support, const InputPlace& place) const;
  void check_springs(const Vector3& stiffness, const std::array<bool, 3>& fixed, const std::string& parameter,
                     const std::string& fixing, const InputPlace& place) const;
  void check_holds_still(const List& list, const InputPlace& place) const;
  void complete_axes(Axes& axes, const InputPlace& place) const;

  Joint read_joint(const List& list, const InputPlace& place);
  void join(const std::string& text, Joint& joint, const InputPlace& place);
  bool is_someone_left(const Joint& joint) const;
  void check_someone_is_left(const Joint& joint) const;

  std::string follower_member(const std::string& text, const std::string& point, const InputPlace& place) const;
  /// Instead of the constant `name`, the three formulas of `name` + " Formula" may be given.
  void check_field(const List& list, const std::string& name, const std::vector<const Member*>& members,
                   const std::array<std::string, 3>& formula, const InputPlace& place) const;
  ReferenceCurve curve_of(const Member& member) const;
  Formulas along(const Member& member, Formulas formula, const InputPlace& place) const;
  void add_temperature(EigenstrainDraft& strain, const InputPlace& place) const;
  std::shared_ptr<const FieldTable> read_field_table(const List& list, const std::string& field,
                                                     const std::vector<const Member*>& members,
                                                     const InputPlace& place) const;
  void check_any_given(const List& list, const std::vector<std::string>& parameters, const std::string& problem,
                       const InputPlace& place) const;

  /// Puts the number of its stage into the formulas of what acts; checks and remembers when it acts.
  template <class Acting>
  void check_schedule(Acting& acting, const List& list, const InputPlace& place) {
    const auto put_stage = [&acting](std::string& formula) {
      formula = with_names_replaced(
          formula, [&](const std::string& name) { return name == "stage" ? std::to_string(acting.stage) : name; });
    };
    put_stage(acting.amplitude);
    using Kind = std::conditional_t<std::is_base_of_v<Eigenstrain, Acting>, Eigenstrain, Acting>;
    ActingKind<Kind>::for_each_vector(acting, [&](Vector3&, Formulas* formula, VectorRole) {
      if (formula != nullptr) std::for_each(formula->begin(), formula->end(), put_stage);
    });
    check_schedule(acting.stage, acting.amplitude, acting.load_case, list, place);
  }
  void check_schedule(Stage stage, const std::string& amplitude, const std::string& load_case, const List& list,
                      const InputPlace& place);
  void check_case_of_modes() const;
  void check_stages();
  void check_stages_of_case(const std::set<std::string>& acting) const;
  void check_amplitudes() const;

  /// What the parameter "Point" or "Member" means, wildcards included. Throws unless members touch these points.
  std::vector<std::string> points_meant(const List& list, const InputPlace& place);
  std::vector<const Member*> members_meant(const List& list, const InputPlace& place);
  void count(std::size_t more, const InputPlace& place);

  const List& scene_list_;
  const InputPlace& place_;
  Scene& scene_;
  const std::vector<CopiedPattern>& copies_;
  const SceneNames names_;
  /// (kind) of everything that acts, but for weights: the name under which it was written.
  std::unordered_map<std::string, std::vector<std::string>> entries_;
  std::unordered_map<std::string, std::string> support_at_;           ///< point -> name of its support
  std::unordered_map<std::string, std::set<std::string>> joined_at_;  ///< point -> members in a joint there
  std::set<std::string> with_tables_;                                 ///< members that have tables of strains
  std::vector<UsedStage> stages_used_;
  std::vector<std::pair<std::string, InputPlace>> amplitudes_;
  std::size_t conditions_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace mixbeam
