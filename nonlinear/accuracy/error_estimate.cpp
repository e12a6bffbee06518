#include "nonlinear/accuracy/error_estimate.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/state/difference.hpp"
#include "discretization/state/sampling.hpp"
#include "discretization/state/transfer.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/element/layout.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/newton/beam_group.hpp"
#include "nonlinear/sensitivity/adjoint_operator.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// The scene with a richer space.
struct RicherScene {
  std::shared_ptr<Scene> scene;
  std::vector<unsigned char> is_halved;  ///< (member): two elements instead of each one; else a higher order
};

void halve_elements(const MeshMember& mesh, Member& member) {
  member.elements = 2 * mesh.elements;
  if (mesh.has_equal_elements && member.inner_points.empty() && member.stations.empty()) return;
  member.stations.assign(1, 0.0);
  for (int i = 0; i < mesh.elements; ++i) {
    member.stations.push_back(mesh.arc_length(i, 0.0) / mesh.curve.length);
    member.stations.push_back(mesh.vertex_arc_length(i + 1) / mesh.curve.length);
  }
  member.stations.back() = 1.0;
}

/// Limits of elements per member, and of members, for small meshes. On these the error of the next order often has the
/// opposite sign, and two orders more cost little compared to work that does not depend on the mesh.
constexpr int kFewElements = 2;
constexpr size_t kFewMembers = 3;

/// Increase of the order for an estimate: the same in all members, so that their shares are comparable.
int more_orders(const std::vector<Member>& members) {
  const auto allows_two = [](const Member& member) {
    return member.elements <= kFewElements && member.order + 2 <= kMaximumOrder;
  };
  return members.size() <= kFewMembers && std::all_of(members.begin(), members.end(), allows_two) ? 2 : 1;
}

/// Raises the order of every member by `more`; members of the highest order get two elements instead of each one.
/// `more` = 0: every element is halved.
RicherScene richer_scene(const Model& model, int more) {
  const Scene& scene = model.scene();
  std::shared_ptr<const Mesh> mesh;
  RicherScene richer{std::make_shared<Scene>(scene), std::vector<unsigned char>(scene.members.size(), 0)};
  for (size_t m = 0; m < scene.members.size(); ++m) {
    Member& member = richer.scene->members[m];
    richer.is_halved[m] = more == 0 || member.order == kMaximumOrder;
    if (!richer.is_halved[m]) {
      member.order += more;
      continue;
    }
    if (mesh == nullptr) mesh = model.whole_mesh();
    halve_elements(mesh->members[m], member);
  }
  return richer;
}

/// Thrown if there is no estimate, with the reason.
struct NotEstimated {
  std::string reason;
};

/// Newton's method in the richer space, step by step.
class RicherSolve {
 public:
  RicherSolve(const Teuchos::RCP<BeamProblem>& problem, const State& start, double load_factor, bool estimates = true)
      : problem_(problem), load_factor_(load_factor) {
    choice_.may_iterate = true;
    choice_.is_last = estimates;
    stand_at(start);
  }

  const State& state() const { return group_->state(); }
  double residual() const { return group_->getNormF(); }
  int corrections() const { return corrections_; }

  /// Corrects with the present tangent.
  void correct() {
    tangent_ = group_;
    Teuchos::ParameterList none;
    tangent_->computeNewton(none);
    move(tangent_->getNewton(), 1.0);
  }
  /// Corrects with the tangent of the last correct().
  void correct_with_old_tangent() {
    BeamVector rows(BeamVector::of(group_->getF()).clone(true));
    unscale_rows(problem_->model, group_->scales(), rows.values());
    scale_rows(problem_->model, tangent_->scales(), rows.values());
    BeamVector response(problem_->model.create_vector());
    Teuchos::ParameterList none;
    tangent_->applyJacobianInverse(none, rows, response);
    move(response, -1.0);
  }

 private:
  void stand_at(const State& state) {
    group_ = Teuchos::rcp(new BeamGroup(problem_, state, load_factor_, choice_));
    group_->computeF();
  }
  void move(const NOX::Abstract::Vector& increment, double step) {
    stand_at(moved(*problem_, state(), BeamVector::of(increment), step));
    ++corrections_;
    if (!problem_->last_failure.empty()) throw NotEstimated{problem_->last_failure};
    if (!std::isfinite(residual())) throw NotEstimated{"the residual of the correction is not finite"};
  }

  Teuchos::RCP<BeamProblem> problem_;
  double load_factor_;
  TangentChoice choice_;
  Teuchos::RCP<BeamGroup> group_, tangent_;
  int corrections_ = 0;
};

/// Sums differences over the elements of the richer mesh, into elements of the mesh.
void add_differences(const Mesh& mesh, const Model& richer, const StateDifference& difference,
                     ErrorEstimate& estimate) {
  const double length = mesh.total_length();
  const Structure& structure = richer.structure();
  const Teuchos::Comm<int>& comm = *richer.map()->getComm();
  estimate.element_displacement.assign(mesh.elements.size(), 0.0);
  estimate.element_moment.assign(mesh.elements.size(), 0.0);
  for (const int local : structure.elements_in_order) {
    const MeshElement& element = richer.mesh().elements[structure.local_element_to_mesh[local]];
    if (!structure.partition.owns(element.vertex[0])) continue;
    const int parts = richer.mesh().elements_of(element.member) / mesh.elements_of(element.member);
    const int here = mesh.first_element[element.member] + element.index / parts;
    const ElementDifference& part = difference.elements[local];
    estimate.element_displacement[here] += part.displacement / length;
    estimate.element_moment[here] += part.moment / length;
    estimate.displacement.size += part.displacement_size / length;
    estimate.moment.size += part.moment_size / length;
  }
  const auto close = [&comm](std::vector<double>& elements, RecordedError& total) {
    sum_over_ranks(comm, elements.data(), elements.size());
    sum_over_ranks(comm, &total.size, 1);
    for (double& square : elements) {
      total.error += square;
      square = std::sqrt(square);
    }
    total.error = std::sqrt(total.error);
    total.size = std::sqrt(total.size);
  };
  close(estimate.element_displacement, estimate.displacement);
  close(estimate.element_moment, estimate.moment);
}

/// Returns (vertex of the richer mesh): its error, for vertices of elements.
std::vector<Vector3> vertex_errors(const Model& richer, const StateDifference& difference) {
  const Structure& structure = richer.structure();
  std::vector<Vector3> errors(static_cast<size_t>(richer.mesh().vertices()));
  for_each_element(structure, [&](const ElementView& element) {
    for (int end = 0; end < 2; ++end)
      if (const int v = element.vertex(end); v < structure.owned_vertices)
        errors[structure.local_vertex_to_global[v]] = difference.vertex_displacement[v];
  });
  sum_over_ranks(*richer.map()->getComm(), errors.front().data(), 3 * errors.size());
  return errors;
}

/// Adds the errors of vertices, which are vertices of the richer mesh too.
void add_vertices(const Model& model, const Model& richer, const StateDifference& difference, ErrorEstimate& estimate) {
  std::vector<Vector3> there = vertex_errors(richer, difference);
  estimate.largest_displacement.size = difference.largest_displacement;
  if (richer.mesh().elements.size() == model.mesh().elements.size()) {  // no element is halved: the same vertices
    for (const Vector3& error : there)
      estimate.largest_displacement.error =
          std::max(estimate.largest_displacement.error, std::hypot(error[0], error[1], error[2]));
    estimate.vertex_displacement = std::move(there);
    return;
  }
  const auto mesh = model.whole_mesh(), fine = richer.whole_mesh();
  estimate.vertex_displacement.resize(mesh->vertex_position.size());
  for (const MeshElement& element : mesh->elements) {
    const int parts = fine->elements_of(element.member) / mesh->elements_of(element.member);
    for (int end = 0; end < 2; ++end) {
      const int at = fine->first_element[element.member] + parts * element.index + (end == 0 ? 0 : parts - 1);
      const Vector3& error = there[fine->elements[at].vertex[end]];
      estimate.vertex_displacement[element.vertex[end]] = error;
      estimate.largest_displacement.error =
          std::max(estimate.largest_displacement.error, std::hypot(error[0], error[1], error[2]));
    }
  }
}

double total(const StrainEnergy& energy) { return energy.force + energy.moment; }

/// Compares `state` with its correction in the richer space; `start`: the fields of `state` there.
ErrorEstimate compare(const Model& model, const State& state, const Model& richer, const State& start,
                      const State& corrected) {
  ErrorEstimate estimate;
  const StateDifference moved = difference(richer, start, corrected);
  add_differences(model.mesh(), richer, moved, estimate);
  add_vertices(model, richer, moved, estimate);
  estimate.energy.size = total(strain_energy(richer, corrected));
  estimate.energy.error = estimate.energy.size - total(strain_energy(model, state));
  return estimate;
}

/// Relative error below which a quantity is exact up to rounding.
constexpr double kLeastError = 1e-12;

/// Smallest of the relative errors.
double smallest(const ErrorEstimate& estimate) {
  double least = 1.0;
  for (const RecordedError* quantity :
       {&estimate.largest_displacement, &estimate.displacement, &estimate.moment, &estimate.energy}) {
    const double relative = std::abs(quantity->relative());
    if (relative > kLeastError) least = std::min(least, relative);
  }
  return least;
}

/// Ratio of the residual to the smallest relative error below which it does not affect it: scaled residuals are of the
/// order of relative errors. Of the energy errors of eight scenes 96 % were within a factor of five with a ratio of
/// one, 98 % with 0.1 and 98.5 % with 0.01; the rest are cells where the energy error changes its sign.
constexpr double kVisible = 0.01;
/// Reduction of the residual above which a correction, and its tangent, were inaccurate.
constexpr double kFarOff = 0.1;
/// Limit of corrections: more than two help only if elements rotate by about one radian.
constexpr int kMostCorrections = 4;

ErrorEstimate estimate_in(const RicherScene& richer, BeamProblem& of, const SolverParameters& parameters,
                          const State& state, double load_factor) {
  const Model& model = of.model;
  of.release_idle();  // makes room for the richer space
  const auto problem = Teuchos::rcp(new BeamProblem(richer.scene, model.map()->getComm(), parameters, of.loca));
  problem->take_over(of);
  const State start = transfer(model, state, problem->model);
  std::vector<unsigned char> raised = richer.is_halved;
  for (unsigned char& member : raised) member = !member;
  RicherSolve solve(problem, with_recovered_rotations(problem->model, start, raised), load_factor);
  const double first = solve.residual();
  double before = first;
  solve.correct();
  ErrorEstimate estimate = compare(model, state, problem->model, start, solve.state());
  while (solve.corrections() < kMostCorrections && solve.residual() > parameters.newton.residual_tolerance &&
         solve.residual() > kVisible * smallest(estimate)) {
    const bool was_good = solve.residual() <= kFarOff * before;
    before = solve.residual();
    was_good ? solve.correct_with_old_tangent() : solve.correct();
    estimate = compare(model, state, problem->model, start, solve.state());
  }
  if (solve.residual() > std::max(first, parameters.newton.residual_tolerance))
    throw NotEstimated{"Newton's method does not converge in the richer space; the mesh is too coarse"};
  estimate.corrections = solve.corrections();
  estimate.richer = problem;
  estimate.richer_state = solve.state();
  problem->model.release_idle_arrays();
  return estimate;
}

}  // namespace

State polished(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& state,
               double load_factor) {
  RicherSolve solve(problem, state, load_factor, false);
  const double most = std::max(solve.residual(), parameters.newton.residual_tolerance);
  try {
    solve.correct();
  } catch (const LinearSolverError&) {
    return state;
  } catch (const NotEstimated&) {  // a failed solve, or NaN
    return state;
  }
  return solve.residual() <= most ? solve.state() : state;
}

Teuchos::RCP<BeamProblem> richer_problem(const BeamProblem& problem, const SolverParameters& parameters) {
  const Model& model = problem.model;
  return Teuchos::rcp(new BeamProblem(richer_scene(model, more_orders(model.scene().members)).scene,
                                      model.map()->getComm(), parameters, problem.loca));
}

State with_layers(const Teuchos::RCP<BeamProblem>& problem, const State& state, double load_factor,
                  const std::vector<EndLayer>& layers) {
  const Model& model = problem->model;
  BeamGroup group(problem, state, load_factor);
  group.computeF();
  group.computeJacobian();
  BeamVector rows(model.create_vector()), response(model.create_vector());
  const std::vector<int>& vertices = model.structure().local_vertex_to_global;
  const auto owned = vertices.begin() + model.structure().owned_vertices;
  for (const EndLayer& layer : layers) {
    const auto add = [&](int vertex, size_t first, double sign, const Vec3<double>& part) {
      const auto place = std::find(vertices.begin(), owned, vertex);
      if (place == owned || !layer.is_known) return;
      first += kVertexDofs * static_cast<size_t>(place - vertices.begin());
      for (size_t i = 0; i < 3; ++i) rows.values().vertex()(first + i) += sign * part[i];
    };
    add(layer.vertex, 3, -layer.side, layer.surplus);
    add(layer.vertex, 0, 1.0, layer.push);
    add(layer.other, 0, -1.0, layer.push);
  }
  model.project_on_free_motions(state, rows.values().vertex());
  scale_rows(model, group.scales(), rows.values());
  Teuchos::ParameterList none;
  group.applyJacobianInverse(none, rows, response);
  BeamGroup moved(group, NOX::ShapeCopy);
  moved.computeX(group, response, -1.0);
  return moved.state();
}

std::vector<double> shares_of_members(const Model& model, const State& state, double load_factor,
                                      const ErrorEstimate& estimate, const StateDerivative& quantity) {
  const Model& richer = estimate.richer->model;
  std::vector<unsigned char> raised;
  for (size_t m = 0; m < model.scene().members.size(); ++m)
    raised.push_back(richer.scene().members[m].order > model.scene().members[m].order);
  State start = with_recovered_rotations(richer, transfer(model, state, richer), raised);
  start.in_plane = false;
  MixedVector rows = richer.create_vector();
  element_rows(richer, start, load_factor, ElementLoads::with_centrifugal, rows);
  const KernelView<double*> vertex = rows.vertex();
  for (const auto& energy : richer.external()) energy->add_rows(start, load_factor, vertex);
  weigh_force_rows(richer.structure(), false, rows);
  AdjointOperator at(*estimate.richer, estimate.richer_state, load_factor);
  const MixedVector adjoint = at.solve(quantity).field;
  const KernelView<const double*> motion = adjoint.vertex();
  const Adjacency adjacency = richer.adjacency();
  std::vector<double> shares(model.scene().members.size(), 0.0);
  for_each_element(richer.structure(), [&](const ElementView& element) {
    const double* of = element.increments_in(adjoint.interior());
    const double* row = element.increments_in(rows.interior());
    double sum = 0.0;
    for (int i = 0; i < element.layout().increments(); ++i) sum += of[i] * row[i];
    for (int end = 0; end < 2; ++end) {
      const int v = element.vertex(end);
      for (size_t i = vertex_row(v, 0); i < vertex_row(v, kVertexDofs); ++i)
        sum += motion(i) * vertex(i) / (adjacency.start(v + 1) - adjacency.start(v));
    }
    shares[static_cast<size_t>(richer.mesh().elements[static_cast<size_t>(element.mesh_element())].member)] += sum;
  });
  return shares;
}

ErrorEstimate estimate_error(BeamProblem& problem, const SolverParameters& parameters, const State& state,
                             double load_factor) {
  const Model& model = problem.model;
  ErrorEstimate none;
  for (int more = more_orders(model.scene().members); more > 0;
       --more) {  // on a very coarse mesh only a smaller increase of the order may converge
    try {
      return estimate_in(richer_scene(model, more), problem, parameters, state, load_factor);
    } catch (const NotEstimated& cause) {
      none.not_estimated = cause.reason;
    } catch (const std::invalid_argument& error) {  // from the transfer
      none.not_estimated = error.what();
    } catch (const LinearSolverError& error) {  // from a singular tangent
      none.not_estimated = error.what();
    } catch (const InputError& error) {  // from the richer scene
      none.not_estimated = error.what();
    }
  }
  return none;
}

}  // namespace mixbeam
