#include "discretization/assembly/masses.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/text/errors.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Entries of a body: velocity and spin.
constexpr int kOfBody = 6;
/// A larger cosine with the normal of the plane means along it, as for Model::plane().
constexpr double kAlongNormal = 0.5;
/// Out-of-plane share of a momentum that rounding of axes may cause.
constexpr double kSymmetric = 1e-10;

/// Throws InputError if in-plane motions share a momentum with out-of-plane ones.
void require_symmetry(double shared, double whole, const char* what) {
  if (std::abs(shared) > kSymmetric * whole)
    throw InputError(
        std::string("\"In Plane\" of the list \"Modes\": the inertia of ") + what +
        " is not symmetric about the plane of the scene, so that its motions leave it; allowed: without it");
}

/// Momenta of a body due to its motion, along its axes (rows).
Mat rooted(const Vec& masses, Mat axes) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) axes(i, j) *= std::sqrt(masses[i]);
  return axes;
}

bool has_rotary_inertia(const ElementBlock& block, const KernelView<double**>& mass) {
  for (int e = 0; e < block.count; ++e)
    for (int q = 0; q <= block.order; ++q)
      for (int i = 3; i < 6; ++i)
        if (mass(e, kMassNumbers * q + triangle(i, i)) != 0.0) return true;
  return false;
}

}  // namespace

void require_plane(const Model& model) {
  if (!model.plane_of_scene())
    throw InputError(
        "\"In Plane\" of the list \"Modes\": the scene keeps to no plane; allowed: scenes that lie in one with their "
        "loads and supports, whose sections have an axis along its normal, without tapers and coupled sections");
}

Masses::Masses(const Model& model, bool in_plane) : model_(&model), in_plane_(in_plane) {
  const Structure& structure = model.structure();
  bodies_ = vertex_bodies(model.scene(), model.mesh(), structure);
  if (in_plane) require_plane(model);
  int most = 0;
  for (const ElementBlock& block : structure.blocks) {
    const KernelView<double**> mass("mixbeam::vibration::mass", block.count, kMassNumbers * (block.order + 1));
    fill_masses(model.scene(), model.mesh(), structure, block, mass);
    if (in_plane) keep_in_plane(block, mass);
    // Coriolis forces couple velocities and spins
    const bool has_spins = model.rotating() != nullptr || has_rotary_inertia(block, mass);
    blocks_.push_back(allocate_vibrating_block(block, mass, has_spins));
    most = std::max(most, blocks_.back().momenta());
  }
  stride_ = static_cast<int>(maximum_over_ranks(*model.map()->getComm(), most));
  count_ = stride_ * structure.mesh_elements + kOfBody * static_cast<int>(model.scene().point_masses.size());
  const int local = structure.local_elements();
  condensed_ = KernelView<double**>("mixbeam::vibration::condensed", local, kFullTangent);
  of_elements_ = KernelView<double**>("mixbeam::vibration::momenta", local, stride_);
  vertex_rows_ = KernelView<double* [12]>("mixbeam::vibration::rows", local);
  place_ = KernelView<int*>("mixbeam::vibration::place", local);
  for (int e = 0; e < local; ++e) place_(e) = stride_ * structure.local_element_to_mesh[e];
  take_damping();
  for (VertexBody& body : bodies_)
    if (in_plane) keep_in_plane(body);
}

/// Uses the damping at the middle of each element.
void Masses::take_damping() {
  for (const Section& section : model_->scene().sections)
    damped_ = damped_ || section.mass_damping > 0.0 || section.stiffness_damping > 0.0;
  if (!damped_) return;
  const Mesh& mesh = model_->mesh();
  const Teuchos::Comm<int>& comm = *model_->map()->getComm();
  damping_.resize(model_->structure().mesh_elements);
  int member = -1;
  SectionLaw law;
  for_each_element(model_->structure(), [&](const ElementView& view) {
    if (!view.is_owned()) return;
    const MeshElement& element = mesh.elements[view.mesh_element()];
    if (element.member != member) law = SectionLaw(model_->scene(), model_->scene().members[element.member]);
    member = element.member;
    const Section section = law.section(mesh.arc_length(element, 0.0) / mesh.member_length[member]);
    damping_[view.mesh_element()] = {section.mass_damping, section.stiffness_damping};
  });
  sum_over_ranks(comm, damping_.data()->data(), 2 * damping_.size());
  if (std::none_of(damping_.begin(), damping_.end(), [](const auto& of) { return of[1] > 0.0; })) return;
  int stride = 0;
  for (const VibratingBlock& block : blocks_) stride = std::max(stride, block.layout().stresses());
  strain_stride_ = static_cast<int>(maximum_over_ranks(comm, stride));
  strain_count_ = strain_stride_ * model_->structure().mesh_elements;
  strains_ = KernelView<double**>("mixbeam::vibration::strains", model_->structure().local_elements(), strain_stride_);
}

std::vector<double> Masses::damped_strains_of(const MixedVector& motion) const {
  if (strain_count_ == 0) return {};
  std::vector<double> all = rows_of_elements(MotionRow::strain, model_->local_increment(motion), motion);
  for (size_t i = 0; i < all.size(); ++i) all[i] *= damping_[i / strain_stride_][1];
  return all;
}

std::vector<double> Masses::damped_momenta(const double* momenta) const {
  std::vector<double> damped(count_, 0.0);
  if (!coriolis_.empty() || !of_bodies_.empty()) add_coriolis(momenta, damped);
  for (size_t e = 0; e < damping_.size(); ++e)
    for (size_t i = stride_ * e; i < stride_ * (e + 1); ++i) damped[i] += damping_[e][0] * momenta[i];
  return damped;
}

size_t Masses::place_of(const VertexBody& body) const {
  return static_cast<size_t>(stride_) * model_->structure().mesh_elements + kOfBody * static_cast<size_t>(body.number);
}

void Masses::take_coriolis(const EvaluationPoint& at) {
  coriolis_.clear();
  of_bodies_.clear();
  const Vec spin = model_->frame().at(at.load_factor);
  if (norm(spin) == 0.0) return;
  for (size_t b = 0; b < blocks_.size() && model_->rotating() != nullptr; ++b) {
    const ElementBlock& block = blocks_[b].block;
    coriolis_.emplace_back("mixbeam::frame::coriolis", block.count, 36 * (block.order + 1));
    coriolis_matrices(block, model_->rotating()->frame(b, spin), at.state.views, coriolis_.back());
  }
  for (const VertexBody& body : bodies_) {
    MotionForm inertia{};
    for (int i = 0; i < 3; ++i) inertia.turned(i, i) = body.inertia[i];
    Mat w = CarriedMass(inertia, {}, body.turned_axes(at.state) * spin).coriolis().turned;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double product = body.inertia[i] * body.inertia[j];  // zero: the couple is rounding
        w(i, j) = product > 0.0 ? w(i, j) / std::sqrt(product) : 0.0;
      }
    of_bodies_.push_back({2.0 * hat(body.axes * spin), w});
  }
}

/// Adds the forces; each rank computes those of its own elements and bodies.
void Masses::add_coriolis(const double* momenta, std::vector<double>& forces) const {
  std::vector<double> mine(count_, 0.0);
  for (size_t b = 0; b < coriolis_.size(); ++b)
    for (int e = 0; e < blocks_[b].block.count; ++e) {
      const ElementView element(model_->structure(), blocks_[b].block, e);
      if (!element.is_owned()) continue;
      const size_t first = static_cast<size_t>(stride_) * element.mesh_element();
      for (int i = 0; i < 6 * (element.order() + 1); ++i)
        for (int j = 0; j < 6; ++j) mine[first + i] += coriolis_[b](e, 6 * i + j) * momenta[first + i / 6 * 6 + j];
    }
  for (size_t i = 0; i < of_bodies_.size(); ++i)
    for (size_t part = 0; part < 2; ++part) {
      const size_t first = place_of(bodies_[i]) + 3 * part;
      store_vector(of_bodies_[i][part] * load_vector(momenta + first), &mine[first]);
    }
  sum_over_ranks(*model_->map()->getComm(), mine.data(), mine.size());
  for (size_t i = 0; i < mine.size(); ++i) forces[i] += mine[i];
}

/// Removes the mass of velocities along the normal of the plane and of spins about other axes.
void Masses::keep_in_plane(const ElementBlock& block, const KernelView<double**>& mass) const {
  const PlaneAxes& plane = *model_->plane_of_scene();
  for (int e = 0; e < block.count; ++e) {
    const double* end = &block.reference(e, block.reference_layout.end_triad(0));
    const Vec along = transpose_times(rotation_matrix(load_quaternion(end)), plane.n);
    const auto leaves = [&](int i) { return (std::abs(along[i % 3]) > kAlongNormal) == (i < 3); };
    for (int q = 0; q <= block.order; ++q)
      for (int row = 0; row < 6; ++row) {
        double shared = 0.0, whole = 0.0;
        for (int i = 0; i <= row; ++i) {
          double& number = mass(e, kMassNumbers * q + triangle(row, i));
          whole = std::hypot(whole, number);
          if (leaves(i) != leaves(row)) shared = std::max(shared, std::abs(number));
          if (leaves(i)) number = 0.0;
        }
        require_symmetry(shared, whole, "a section");
      }
  }
}

void Masses::keep_in_plane(VertexBody& body) const {
  const PlaneAxes& plane = *model_->plane_of_scene();
  const Vec along = body.axes * plane.n;
  Vec spun = along;
  for (int i = 0; i < 3; ++i) spun[i] *= body.inertia[i];
  const double about = dot(along, spun);
  require_symmetry(norm(spun - about * along), norm(body.inertia), "a body");
  for (int i = 0; i < 3; ++i) body.axes(0, i) = plane.p[i], body.axes(1, i) = plane.q[i], body.axes(2, i) = plane.n[i];
  body.mass[2] = 0.0;
  body.inertia = {{0.0, 0.0, about}};
}

/// Adds springs out of the plane, of arbitrary size: the directions that they hold have no mass.
void Masses::hold_vertices() const {
  const Structure& structure = model_->structure();
  const double length = structure.shortest_element, turning = structure.bending_reference / length;
  const Vec normal = model_->plane_of_scene()->n;
  const Mat along = outer(normal, normal);
  const Mat force = (turning / (length * length)) * along, moment = turning * (identity_matrix<double>() - along);
  for (int e = 0; e < structure.local_elements(); ++e)
    for (int part = 0; part < 12; part += 3)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          condensed_(e, 12 * (part + i) + part + j) += part % kVertexDofs == 0 ? force(i, j) : moment(i, j);
}

void Masses::condense(const Tangent& at, double shift, VibrationUse use) {
  StructureViews structure = at.cap().structure;
  structure.field_value = at.point().line_fields;
  const RotatingElements* rotating = model_->rotating();
  for (size_t b = 0; b < blocks_.size(); ++b) {
    if (use == VibrationUse::columns) allocate_columns(blocks_[b], structure);
    evaluate_vibration(
        blocks_[b], structure, at.point().state.views, shift, use, condensed_,
        rotating == nullptr ? FrameViews{} : rotating->frame(b, rotating->spin().at(at.point().load_factor)));
  }
  if (in_plane_) hold_vertices();
  take_coriolis(at.point());
}

void Masses::add_bodies(const Tangent& at, double shift, const MatrixRows& rows) const {
  for (const VertexBody& body : bodies_) {
    const Mat moved = rooted(body.mass, body.axes), turned = rooted(body.inertia, body.turned_axes(at.point().state));
    rows.add(body.vertex, kForcePart, body.vertex, kForcePart, shift * (transpose(moved) * moved));
    rows.add(body.vertex, kMomentPart, body.vertex, kMomentPart, shift * (transpose(turned) * turned));
  }
}

std::vector<int> Masses::body_vertices() const {
  std::vector<int> vertices;
  for (const VertexBody& body : bodies_) vertices.push_back(body.vertex);
  return vertices;
}

Tangent::InteriorCount Masses::interior_count() const {
  double sums[2] = {0.0, 0.0};
  for (const VibratingBlock& block : blocks_)
    for (int e = 0; e < block.block.count; ++e) {
      if (!ElementView(model_->structure(), block.block, e).is_owned()) continue;
      const int negative = block.negative(e);
      sums[negative == kUncertainCount ? 1 : 0] += negative == kUncertainCount ? 1.0 : negative;
    }
  sum_over_ranks(*model_->map()->getComm(), sums, 2);
  return {static_cast<long>(sums[0]), sums[1] > 0.0};
}

std::vector<double> Masses::momenta_of(const State& state, const MixedVector& motion) const {
  const KernelView<const double* [6]> vertex = model_->local_increment(motion);
  std::vector<double> all = rows_of_elements(MotionRow::momentum, vertex, motion);
  const size_t elements = all.size();
  all.resize(count_, 0.0);
  take_momenta_of_bodies(state, vertex, all.data());
  sum_over_ranks(*model_->map()->getComm(), all.data() + elements, count_ - elements);
  return all;
}

/// Rows of the mesh elements of all ranks, one stride each.
std::vector<double> Masses::rows_of_elements(MotionRow row, const KernelView<const double* [6]>& vertex,
                                             const MixedVector& motion) const {
  const bool are_momenta = row == MotionRow::momentum;
  const KernelView<double**>& of_elements = are_momenta ? of_elements_ : strains_;
  const size_t stride = of_elements.extent(1);
  std::vector<double> all(stride * model_->structure().mesh_elements, 0.0);
  for (const VibratingBlock& block : blocks_) {
    rows_of_motion(block, row, vertex, motion.interior(), of_elements);
    for (int e = 0; e < block.block.count; ++e) {
      const ElementView element(model_->structure(), block.block, e);
      const int count = are_momenta ? block.momenta() : block.layout().stresses();
      if (element.is_owned())
        std::copy_n(&of_elements(element.local(), 0), count, &all[stride * element.mesh_element()]);
    }
  }
  sum_over_ranks(*model_->map()->getComm(), all.data(), all.size());
  return all;
}

void Masses::take_momenta_of_bodies(const State& state, const KernelView<const double* [6]>& vertex,
                                    double* momenta) const {
  for (const VertexBody& body : bodies_) {
    double* out = momenta + place_of(body);
    const double* moved = &vertex(body.vertex, 0);
    store_vector(rooted(body.mass, body.axes) * load_vector(moved), out);
    store_vector(rooted(body.inertia, body.turned_axes(state)) * load_vector(moved + 3), out + 3);
  }
}

/// Sums `of` (local element, 12 * column) in arrays (column) over owned vertices.
void Masses::gather_vertices(const std::vector<double*>& rows, const KernelView<const double**>& of) const {
  const Adjacency adjacency = model_->adjacency();
  Kokkos::parallel_for(
      "mixbeam::vibration::gather", Kokkos::RangePolicy<ExecutionSpace>(0, model_->structure().owned_vertices),
      [adjacency, rows = rows.data(), columns = rows.size(), of](int v) {
        for (size_t column = 0; column < columns; ++column) {
          double sum[kVertexDofs] = {};
          for (int a = adjacency.start(v); a < adjacency.start(v + 1); ++a) {
            const double* share = &of(adjacency.element(a, 0), 12 * column + kVertexDofs * adjacency.element(a, 1));
            for (int i = 0; i < kVertexDofs; ++i) sum[i] += share[i];
          }
          std::copy_n(sum, kVertexDofs, rows[column] + kVertexDofs * v);
        }
      });
}

void Masses::condense_momenta(const State& state, const double* momenta, MixedVector& rows,
                              const double* strains) const {
  for_each_element(model_->structure(), [&](const ElementView& element) {
    std::copy_n(momenta + static_cast<size_t>(stride_) * element.mesh_element(), stride_,
                &of_elements_(element.local(), 0));
  });
  const KernelView<double*> interior = rows.writable_interior(false);
  for (const VibratingBlock& block : blocks_) {
    rows_of_momenta(block, of_elements_, interior, vertex_rows_);
    for (int e = 0; e < block.block.count && strains != nullptr; ++e) {
      const ElementView element(model_->structure(), block.block, e);
      std::copy_n(strains + static_cast<size_t>(strain_stride_) * element.mesh_element(), block.layout().stresses(),
                  element.increments_in(interior));
    }
    condense_rows(block, interior, vertex_rows_);
  }
  const KernelView<double*> vertex = rows.vertex();
  gather_vertices({vertex.data()}, vertex_rows_);
  add_rows_of_bodies(state, momenta, vertex);
}

void Masses::add_rows_of_bodies(const State& state, const double* momenta, const KernelView<double*>& vertex) const {
  for (const VertexBody& body : bodies_) {
    const double* own = momenta + place_of(body);
    const Vec force = transpose_times(rooted(body.mass, body.axes), load_vector(own)),
              moment = transpose_times(rooted(body.inertia, body.turned_axes(state)), load_vector(own + 3));
    for (int i = 0; i < 3; ++i) {
      vertex(kVertexDofs * body.vertex + i) += force[i];
      vertex(kVertexDofs * body.vertex + 3 + i) += moment[i];
    }
  }
}

void Masses::condense_interior(MixedVector& rows) const {
  Kokkos::deep_copy(vertex_rows_, 0.0);
  for (const VibratingBlock& block : blocks_) condense_rows(block, rows.interior(), vertex_rows_);
  gather_vertices({rows.vertex().data()}, vertex_rows_);
}

MomentumColumns Masses::columns_of(double* momenta, int columns, bool excess) {
  MomentumColumns of{columns, static_cast<size_t>(count_), stride_, place_, momenta, momenta};
  const size_t local = model_->structure().local_elements();
  if (ends_.extent(1) != static_cast<size_t>(12 * columns))
    ends_ = KernelView<double**>("mixbeam::vibration::ends", local, 12 * columns);
  of.ends = ends_;
  for (const VibratingBlock& block : blocks_)
    of.stresses = std::max(of.stresses, static_cast<int>(block.capped.extent(0)));
  if (excess && excess_.extent(1) != static_cast<size_t>(of.stresses) * columns)
    excess_ = KernelView<double**>("mixbeam::vibration::excess_rows", local, of.stresses * columns);
  if (excess) of.excess = excess_;
  return of;
}

void Masses::condense_columns(const State& state, const MomentumColumns& of, std::vector<MixedVector>& rows) const {
  for (const VibratingBlock& block : blocks_) mixbeam::condense_columns(block, of);
  std::vector<double*> gathered;
  for (MixedVector& row : rows) gathered.push_back(row.writable_vertex(false).data());
  gather_vertices(gathered, of.ends);
  for (int j = 0; j < of.columns && of.forces != nullptr; ++j)
    add_rows_of_bodies(state, of.forces + of.momenta_of_column * j, rows[j].vertex());
}

void Masses::recover_columns(const State& state, const MomentumColumns& of,
                             const std::vector<MixedVector>& motions) const {
  const Teuchos::Comm<int>& comm = *model_->map()->getComm();
  const size_t elements = static_cast<size_t>(stride_) * model_->structure().mesh_elements;
  std::vector<const double*> moved;
  std::vector<std::vector<double>> imported(motions.size());  // local_increment() has memory for one
  for (int j = 0; j < of.columns; ++j) {
    const KernelView<const double* [6]> vertex = model_->local_increment(motions[j]);
    moved.push_back(vertex.data());
    if (comm.getSize() == 1) continue;
    imported[j].assign(vertex.data(), vertex.data() + vertex.size());
    moved[j] = imported[j].data();
  }
  MomentumColumns from = of;
  from.moved = moved.data();
  for (const VibratingBlock& block : blocks_) mixbeam::recover_columns(block, from);
  for (int j = 0; j < of.columns; ++j) {
    const KernelView<const double*> own = motions[j].vertex();
    double* all = of.momenta + of.momenta_of_column * j;
    std::fill(all + elements, all + count_, 0.0);
    take_momenta_of_bodies(state, KernelView<const double* [6]>(own.data(), own.extent(0) / kVertexDofs), all);
  }
  if (comm.getSize() == 1) return;
  std::vector<double> mine(count_);
  for (int j = 0; j < of.columns; ++j) {
    double* all = of.momenta + of.momenta_of_column * j;
    std::fill(mine.begin(), mine.end(), 0.0);
    for_each_element(model_->structure(), [&](const ElementView& element) {
      const size_t first = place_(element.local());
      if (element.is_owned()) std::copy_n(all + first, stride_, &mine[first]);
    });
    std::copy_n(all + elements, count_ - elements, mine.data() + elements);
    Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, count_, mine.data(), all);
  }
}

std::vector<double> Masses::excess_norms(const MomentumColumns& of) const {
  std::vector<double> norms(of.columns, 0.0);
  for_each_element(model_->structure(), [&](const ElementView& element) {
    if (!element.is_owned()) return;
    for (int i = 0; i < of.stresses * of.columns; ++i) {
      const double x = of.excess(element.local(), i);
      norms[i / of.stresses] += x * x;
    }
  });
  sum_over_ranks(*model_->map()->getComm(), norms.data(), norms.size());
  for (double& norm : norms) norm = std::sqrt(norm);
  return norms;
}

void Masses::recover(const MixedVector& rows, MixedVector& motion) const {
  const KernelView<const double* [6]> vertex = model_->local_increment(motion);
  const KernelView<double*> interior = motion.writable_interior(false);
  for (const VibratingBlock& block : blocks_) recover_motion(block, rows.interior(), vertex, interior);
}

void Masses::excess_rows(const MixedVector& motion, MixedVector& rows) const {
  Kokkos::deep_copy(rows.vertex(), 0.0);
  const KernelView<double*> interior = rows.writable_interior(false);
  for (const VibratingBlock& block : blocks_) mixbeam::excess_rows(block, motion.interior(), interior);
}

double Masses::stiffness_form(const MixedVector& motion) const {
  const KernelView<const double* [6]> vertex = model_->local_increment(motion);
  const KernelView<double*> forms("mixbeam::vibration::forms", model_->structure().local_elements());
  for (const VibratingBlock& block : blocks_) stiffness_forms(block, vertex, motion.interior(), forms);
  double sum = 0.0;
  for (const int local : model_->structure().elements_in_order)
    if (ElementView(model_->structure(), State{}, local).is_owned()) sum += forms(local);
  return sum_over_ranks(*model_->map()->getComm(), sum);
}

std::vector<double> Masses::translation(const State& state, int axis) const {
  MixedVector motion = model_->create_vector();
  motion.fill(0.0);
  const KernelView<double*> vertex = motion.vertex();
  for (int v = 0; v < model_->structure().owned_vertices; ++v) vertex(vertex_row(v, axis)) = 1.0;
  motion.writable_interior(true);
  return momenta_of(state, motion);
}

}  // namespace mixbeam
