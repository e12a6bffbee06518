/// The work behind read_conditions (reading/conditions/read_conditions.hpp).
#pragma once

#include "discretization/reading/conditions/read_conditions.hpp"
#include "discretization/scene/names.hpp"

#include <set>
#include <unordered_map>
#include <utility>

namespace mixbeam {

/// One pass over what acts on a scene whose points and members are complete.
class ConditionReader {
 public:
  ConditionReader(const Teuchos::ParameterList& scene_list, const ParameterSource& source, const ParameterPath& path,
                  Scene& scene)
      : scene_list_(scene_list), source_(source), path_(path), scene_(scene), names_(scene) {}

  void read();

 private:
  using List = Teuchos::ParameterList;

  /// Stage, amplitude and case of one load, as declared.
  struct Schedule {
    Stage stage = 1;
    std::string amplitude, load_case;

    /// Gives it to a load, support or eigenstrain.
    template <class Acting>
    void assign_to(Acting& acting) const {
      acting.stage = stage;
      acting.amplitude = amplitude;
      acting.load_case = load_case;
    }
  };

  /// A use of a stage: what acts with an amplitude acts in every stage up to its own.
  struct UsedStage {
    Stage first = 1, last = 1;
    std::string load_case;
    ParameterPath path;
  };

  void read_load_cases();
  void read_supports();
  void read_joints();
  void read_point_loads();
  void read_distributed_loads();
  void read_eigenstrains();

  Support read_support(const List& list, const ParameterPath& path);
  void claim_support(const std::string& point, const std::string& name, const ParameterPath& path);
  void check_support(const Support& support, const ParameterPath& path) const;
  void check_springs(const Vector3& stiffness, const std::array<bool, 3>& fixed, const std::string& parameter,
                     const std::string& fixing, const ParameterPath& path) const;
  void check_holds_still(const List& list, const ParameterPath& path) const;
  Axes read_axes(const List& list, const ParameterPath& path) const;

  Joint read_joint(const List& list, const ParameterPath& path);
  void join(const std::string& text, Joint& joint, const ParameterPath& path);
  void check_joint_axis(const List& list, const ParameterPath& path) const;
  void check_someone_is_left(const Joint& joint) const;

  std::string follower_member(const std::string& text, const std::string& point, const ParameterPath& path) const;
  /// The constant of `name`, or the three formulas of `name` + " Formula", of which at most one may be given.
  void read_field(const List& list, const std::string& name, const std::vector<const Member*>& members,
                  Vector3& constant, std::array<std::string, 3>& formula, const ParameterPath& path) const;
  double length_of(const Member& member) const;
  void add_temperature(const List& list, Eigenstrain& strain, const ParameterPath& path) const;
  void check_any_given(const List& list, const std::vector<std::string>& parameters, const std::string& problem,
                       const ParameterPath& path) const;

  /// Reads, checks and remembers when something acts.
  Schedule read_schedule(const List& list, const ParameterPath& path);
  void check_stages();
  void check_stages_of_case(const std::string& load_case) const;
  void check_amplitudes() const;

  /// What the parameter "Point" or "Member" means, wildcards included. Throws unless members touch these points.
  std::vector<std::string> points_meant(const List& list, const ParameterPath& path);
  std::vector<const Member*> members_meant(const List& list, const ParameterPath& path);
  void count(std::size_t more, const ParameterPath& path);

  const List& scene_list_;
  const ParameterSource& source_;
  const ParameterPath& path_;
  Scene& scene_;
  const SceneNames names_;
  std::unordered_map<std::string, std::string> support_at_;           ///< point -> name of its support
  std::unordered_map<std::string, std::set<std::string>> joined_at_;  ///< point -> members in a joint there
  std::vector<UsedStage> stages_used_;
  std::vector<std::pair<std::string, ParameterPath>> amplitudes_;
  std::size_t conditions_ = 0;
};

}  // namespace mixbeam
