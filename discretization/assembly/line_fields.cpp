#include "discretization/assembly/line_fields.hpp"

#include "discretization/mesh/reference_element.hpp"
#include "discretization/scene/formula_pieces.hpp"
#include "kernels/element/layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace mixbeam {

namespace {

/// One or two Gauss rules of a field in an element of a block: the shear part may have its own points.
std::vector<GaussPoints> rules_of(LineField kind, const ElementBlock& block) {
  const int points = line_field_points(kind, block.order, block.interior.force_points);
  const int first = kind == LineField::eigenstrain ? axial_points(block.order, block.force_integration) : points;
  std::vector<GaussPoints> rules{gauss_points(first)};
  if (points > first) rules.push_back(gauss_points(points - first));
  return rules;
}

/// Elements of a member on this rank: their block (-1: none) and their indices in it. A member has one order,
/// integration rule and kind of section, and thus one block.
struct LocalElements {
  int block = -1;
  std::vector<int> elements;
};

int block_holding(const Structure& structure, int local_element) {
  return static_cast<int>(&structure.block_of(local_element) - structure.blocks.data());
}

LocalElements local_elements(const Mesh& mesh, const Structure& structure, int member) {
  LocalElements result;
  for (int i = 0; i < mesh.elements_of(member); ++i) {
    const int local = structure.local_element(mesh.first_element[member] + i);
    if (local < 0) continue;
    if (result.block < 0) result.block = block_holding(structure, local);
    result.elements.push_back(local - structure.blocks[result.block].first_element);
  }
  return result;
}

void ensure_rows(ElementBlock& block) {
  if (block.field_row.extent(0) > 0) return;
  block.field_row = KernelView<int* [kLineFields]>("mixbeam::field_row", block.count);
  Kokkos::deep_copy(block.field_row, -1);
}

bool is_load(LineField kind) { return kind != LineField::eigenstrain && kind != LineField::eigencurvature; }

}  // namespace

/// Component of a load along its member: constant, a formula of s and x, or a table times a factor.
class LineFields::Profile {
 public:
  Profile(const Vector3& constant, const std::array<std::string, 3>& formula, const std::string& member,
          std::shared_ptr<const FieldTable> table = {}, double factor = 1.0)
      : constant_(constant), member_(member), table_(std::move(table)), factor_(factor) {
    for (int i = 0; i < 3; ++i)
      if (!formula[i].empty()) formula_[i].emplace(formula[i], std::vector<std::string>{"s", "x"});
  }
  FormulaVector pieces(double length) const {
    std::array<std::string, 3> text;
    for (int i = 0; i < 3; ++i)
      if (formula_[i]) text[i] = formula_[i]->text();
    return pieces_of(text, length);
  }
  bool is_zero() const {
    if (table_) return false;
    for (int i = 0; i < 3; ++i)
      if (formula_[i] || constant_[i] != 0.0) return false;
    return true;
  }
  double at(int component, double s, double length) const {
    if (table_) return factor_ * table_->at(s)[component];
    if (!formula_[component]) return constant_[component];
    const double value = (*formula_[component])({s, s / length});
    if (!std::isfinite(value))
      throw std::invalid_argument("member \"" + member_ + "\": the formula \"" + formula_[component]->text() +
                                  "\" has no finite value at s = " + std::to_string(s) +
                                  " (x = " + std::to_string(s / length) + ")");
    return value;
  }

 private:
  Vector3 constant_;
  std::array<std::optional<Expression>, 3> formula_{};
  std::string member_;
  std::shared_ptr<const FieldTable> table_;
  double factor_;
};

/// One vector of a DistributedLoad or an Eigenstrain.
struct LineFields::Source {
  LineField kind;
  int member;
  Profile profile;
  Amplitude amplitude;
  const DistributedLoad* load = nullptr;          ///< for more than a profile: a partial, projected or weight load
  std::shared_ptr<const FormulaPieces> taper{};   ///< of a weight load
  const std::array<Vector3, 2>* turns = nullptr;  ///< of an eigencurvature: Eigenstrain::end_turns
};

namespace {

/// Projected length per undeformed length, for a dead force per length seen along its direction.
double seen_length(const MeshMember& member, const Vector3& force, double s) {
  const Vec3<double> tangent = member.curve.tangent(s), direction{{force[0], force[1], force[2]}};
  const Vec3<double> across = cross(tangent, direction);
  return std::sqrt(dot(across, across) / dot(direction, direction));
}

/// Factor of a load profile at arc length s, in an element with midpoint `middle`.
double factor_of(const DistributedLoad& load, const MeshMember& member, const SectionLaw* law, double s,
                 double middle) {
  const double length = member.curve.length;
  if (middle < load.range[0] * length || middle > load.range[1] * length) return 0.0;
  return local_factor(load, member, law, s);
}

bool turns_ends(const Eigenstrain& strain) {
  return !vector_algebra::is_zero(strain.end_turns[0]) || !vector_algebra::is_zero(strain.end_turns[1]);
}

/// Curvature equivalent to concentrated rotations at the ends of an element of this length: the polynomial of the
/// degree of M with their moments, int P_j kappa ds = turn_b + (-1)^j turn_a, the only ones in theory (17).
double concentrated(double turn_a, double turn_b, double length, int order, double xi) {
  double P[kMaximumOrder + 1], sum = 0.0;
  legendre(order, xi, P);
  for (int j = 0; j <= order; ++j) sum += (2 * j + 1) / length * P[j] * (turn_b + (j % 2 == 0 ? turn_a : -turn_a));
  return sum;
}

bool is_plain(const DistributedLoad& load) {
  return !load.is_projected && !load.is_weight && load.range == std::array<double, 2>{0.0, 1.0};
}

}  // namespace

double local_factor(const DistributedLoad& load, const MeshMember& member, const SectionLaw* law, double s) {
  if (load.is_weight && law != nullptr) return law->share_of_mass(s / member.curve.length);
  return load.is_projected ? seen_length(member, load.force, s) : 1.0;
}

LineFields::LineFields(const Scene& scene, const Mesh& mesh, Structure& structure)
    : has_loads_(!scene.distributed_loads.empty()), has_eigenstrains_(!scene.eigenstrains.empty()) {
  for (const DistributedLoad& load : scene.distributed_loads) {
    const int member = member_index(scene, load.member);
    const Amplitude amplitude(load.stage, scene.stages, load.amplitude);
    const bool follower = load.frame == LoadFrame::follower;
    add_source(mesh, structure,
               {follower ? LineField::follower_force : LineField::dead_force, member,
                Profile(load.force, load.force_formula, load.member), amplitude, is_plain(load) ? nullptr : &load,
                load.is_weight ? pieces_of_taper(scene, scene.members[member]) : nullptr});
    add_source(mesh, structure,
               {follower ? LineField::follower_couple : LineField::dead_couple, member,
                Profile(load.couple, load.couple_formula, load.member), amplitude, is_plain(load) ? nullptr : &load});
  }
  for (const Eigenstrain& strain : scene.eigenstrains) {
    const int member = member_index(scene, strain.member);
    const Amplitude amplitude(strain.stage, scene.stages, strain.amplitude);
    add_source(mesh, structure,
               {LineField::eigenstrain, member,
                Profile(strain.strain, strain.strain_formula, strain.member, strain.strain_table, strain.table_factor),
                amplitude});
    Source bending{
        LineField::eigencurvature, member,
        Profile(strain.curvature, strain.curvature_formula, strain.member, strain.curvature_table, strain.table_factor),
        amplitude};
    if (turns_ends(strain)) bending.turns = &strain.end_turns;
    add_source(mesh, structure, bending);
  }
  number_rows(structure);
}

void LineFields::add_source(const Mesh& mesh, Structure& structure, const Source& source) {
  if (source.profile.is_zero() && source.turns == nullptr) return;
  const MeshMember& member = mesh.members[source.member];
  const LocalElements local = local_elements(mesh, structure, source.member);
  if (local.block < 0) return;
  ElementBlock& block = structure.blocks[local.block];
  const std::vector<GaussPoints> rules = rules_of(source.kind, block);
  Field field{source.kind, source.member, local.block, source.amplitude};
  const double length = field.length = member.curve.length;
  field.points = line_field_points(source.kind, block.order, block.interior.force_points);
  field.elements = KernelView<int*>("mixbeam::field_elements", local.elements.size());
  field.value = KernelView<double* [3]>("mixbeam::field_source", local.elements.size() * field.points);
  FormulaVector pieces = source.profile.pieces(length);
  if (source.taper) pieces.component.fill(source.taper);
  ensure_rows(block);
  std::vector<double> value;
  for (size_t i = 0; i < local.elements.size(); ++i) {
    const int e = field.elements(i) = local.elements[i];
    block.kinds_of_fields |= 1U << static_cast<int>(source.kind);
    const MeshElement& element = mesh.elements[structure.local_element_to_mesh[block.first_element + e]];
    const double middle = mesh.arc_length(element, 0.0);
    const double first = mesh.arc_length(element, -1.0) / length, last = mesh.arc_length(element, 1.0) / length;
    size_t row = i * field.points;
    for (const GaussPoints& rule : rules) {
      for (int c = 0; c < 3; ++c) {
        const auto at = [&](double s) {
          const double here = source.profile.at(c, s, length);
          if (source.load == nullptr) return here;
          return here * factor_of(*source.load, member, structure.member_laws[source.member].get(), s, middle);
        };
        value.clear();
        for (const double xi : rule.xi) value.push_back(at(mesh.arc_length(element, xi)));
        if (pieces.component[c])
          integrate_at_points(
              *pieces.component[c], [&](double x) { return at(x * length); }, first, last, rule.xi, rule.weight, value);
        for (size_t q = 0; q < value.size(); ++q) {
          if (source.turns != nullptr)
            value[q] += concentrated(element.index == 0 ? (*source.turns)[0][c] : 0.0,
                                     element.index == member.elements - 1 ? (*source.turns)[1][c] : 0.0,
                                     member.element_length(element.index), block.order, rule.xi[q]);
          field.value(row + q, c) = value[q];
          field.largest = std::max(field.largest, std::abs(value[q]));
        }
      }
      row += rule.xi.size();
    }
  }
  const size_t one = 3 * static_cast<size_t>(field.points);
  const double* first = field.value.data();
  field.apart = std::equal(first + one, first + field.value.size(), first) ? 0 : field.points;
  if (field.apart == 0) Kokkos::resize(field.value, field.points);
  fields_.push_back(field);
}

/// Assigns rows; the elements of a member share one row of a kind if all fields of that kind are equal in all of them.
void LineFields::number_rows(Structure& structure) {
  std::map<std::pair<int, LineField>, int> apart;
  for (const Field& field : fields_) {
    int& most = apart[{field.member, field.kind}];
    most = std::max(most, field.apart);
  }
  for (const Field& field : fields_) {
    const auto row = structure.blocks[field.block].field_row;
    const int kind = static_cast<int>(field.kind), elements = static_cast<int>(field.elements.extent(0));
    if (row(field.elements(0), kind) >= 0) continue;  // assigned by an earlier field
    const int step = apart[{field.member, field.kind}];
    for (int i = 0; i < elements; ++i) row(field.elements(i), kind) = rows_ + i * step;
    rows_ += (elements - 1) * step + field.points;
  }
}

std::vector<double> LineFields::amplitudes(double load_factor, bool with_loads) const {
  std::vector<double> factors;
  for (const Field& field : fields_)
    factors.push_back(with_loads || !is_load(field.kind) ? field.amplitude(load_factor) : 0.0);
  return factors;
}

std::vector<double> LineFields::slopes(double load_factor) const {
  std::vector<double> factors;
  for (const Field& field : fields_) factors.push_back(field.amplitude.slope(load_factor));
  return factors;
}

void LineFields::add_up(const Structure& structure, const std::vector<double>& factors,
                        const KernelView<double* [3]>& sum) const {
  Kokkos::deep_copy(sum, 0.0);
  for (size_t f = 0; f < fields_.size(); ++f) {
    if (factors[f] == 0.0) continue;
    const Field& field = fields_[f];
    const auto row = structure.blocks[field.block].field_row;
    const auto value = field.value;
    const auto elements = field.elements;
    const int kind = static_cast<int>(field.kind), points = field.points, apart = field.apart;
    const double factor = factors[f];
    const int all = static_cast<int>(elements.extent(0));
    const bool share = all > 1 && row(elements(0), kind) == row(elements(1), kind);
    Kokkos::parallel_for(
        "mixbeam::line_fields", Kokkos::RangePolicy<ExecutionSpace>(0, share ? 1 : all), KOKKOS_LAMBDA(int i) {
          const int first = row(elements(i), kind);
          for (int q = 0; q < points; ++q)
            for (int c = 0; c < 3; ++c) sum(first + q, c) += factor * value(i * apart + q, c);
        });
  }
}

bool LineFields::keep_in_plane(const Structure& structure, const Vec& normal, double tolerance) const {
  for (const Field& field : fields_) {
    const ElementBlock& block = structure.blocks[field.block];
    const bool in_space = field.kind == LineField::dead_force || field.kind == LineField::dead_couple;
    const bool is_axial = field.kind == LineField::dead_couple || field.kind == LineField::follower_couple ||
                          field.kind == LineField::eigencurvature;
    for (size_t row = 0; row < field.elements.extent(0) * field.points; ++row) {
      const int e = field.elements(row / field.points);
      const size_t own = field.apart == 0 ? row % field.points : row;
      const Vec value = load_vector(&field.value(own, 0));
      const Mat triad = rotation_matrix(load_quaternion(&block.reference(e, block.reference_layout.end_triad(0))));
      const Vec along = in_space ? normal : transpose_times(triad, normal);
      // couples and curvatures must be about the normal, all others in the plane
      const double out = is_axial ? norm(cross(value, along)) : dot(value, along);
      if (!(std::abs(out) <= tolerance * field.largest)) return false;
    }
  }
  return true;
}

bool LineFields::have_planar_equations() const {
  return std::all_of(fields_.begin(), fields_.end(), [](const Field& field) {
    return field.kind == LineField::dead_force || field.kind == LineField::eigenstrain ||
           field.kind == LineField::eigencurvature;
  });
}

LineFieldMagnitude LineFields::magnitude(double load_factor) const {
  LineFieldMagnitude sizes;
  const auto raise = [](double& largest, double value) { largest = std::max(largest, value); };
  for (const Field& field : fields_) {
    const double size = std::abs(field.amplitude(load_factor)) * field.largest;
    switch (field.kind) {
      case LineField::dead_force:
      case LineField::follower_force:
        raise(sizes.force, size * field.length);
        break;
      case LineField::dead_couple:
      case LineField::follower_couple:
        raise(sizes.couple, size * field.length);
        break;
      case LineField::eigenstrain:
        raise(sizes.strain, size);
        break;
      case LineField::eigencurvature:
        raise(sizes.curvature, size);
        raise(sizes.turn, size * field.length);
        break;
    }
  }
  return sizes;
}

}  // namespace mixbeam
