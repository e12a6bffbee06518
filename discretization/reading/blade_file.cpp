#include "discretization/reading/blade_file.hpp"

#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/text_file.hpp"
#include "kernels/math/constants.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <yaml-cpp/yaml.h>
#include <Teuchos_Array.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace mixbeam {

namespace {

using vector_algebra::cross, vector_algebra::difference, vector_algebra::dot, vector_algebra::unit;

/// Difference of entries across the diagonal, over the roots of their diagonal entries, up to which it may be rounding:
/// files have five digits or more.
constexpr double kAsymmetry = 1e-3;
/// Files round moments of inertia to five digits; the polar one of thin sections is the sum of the others.
constexpr double kRoundedPolar = 1e-3;
/// Distance of stations that count as equal, over the length.
constexpr double kSamePlace = 1e-9;

constexpr const char* kVabsStiffness = "Timoshenko Stiffness Matrix";
constexpr const char* kVabsMass = "The 6X6 Mass Matrix";
constexpr const char* kBecasStiffness = "Stiffness matrix w.r.t. to the cross section reference point";
constexpr const char* kBecasMass = "Mass matrix w.r.t. to the cross section reference point";
constexpr const char* kBeamDynTable = "DISTRIBUTED PROPERTIES";
constexpr const char* kPrintedArray = "0123456789.eE+-[](), \t\r\n";  ///< as NumPy prints or saves numbers

/// Index among (1, 2, 3) of (x, y, z), z along the blade, and of rotations about them: axes permute, without signs.
constexpr std::array<std::size_t, 6> kAlongZ = {1, 2, 0, 4, 5, 3};
constexpr std::array<std::size_t, 6> kAlongX = {0, 1, 2, 3, 4, 5};

InputError bad(const std::string& file, const std::string& problem) { return InputError(file + ": " + problem); }

/// Reads the next 36 numbers.
Matrix6 next_matrix(std::istream& in, const std::array<std::size_t, 6>& order, const std::string& file,
                    const std::string& heading) {
  Matrix6 matrix{};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) {
      std::string word;
      double value = 0.0;
      in >> word;
      const Problem problem = parse_number(word, value);
      if (!problem.empty() || !std::isfinite(value))
        throw bad(file, "\"" + excerpt(heading) + "\": row " + std::to_string(i + 1) + ", column " +
                            std::to_string(j + 1) + " is \"" + excerpt(word) + "\"; allowed: six rows of six numbers");
      matrix[order[i]][order[j]] = value;
    }
  return matrix;
}

/// The matrix below the line that begins with `heading`, after lines of marks and "K="; zero if there is none.
Matrix6 matrix_below(const std::string& text, const std::string& heading, const std::array<std::size_t, 6>& order,
                     const std::string& file) {
  std::istringstream in(text);
  std::string line;
  while (std::getline(in, line))
    if (trimmed(line).rfind(heading, 0) == 0) break;
  if (!in) return {};
  for (std::streampos here = in.tellg(); std::getline(in, line); here = in.tellg())
    if (line.find_first_of("0123456789") != std::string::npos) {
      in.seekg(here);
      return next_matrix(in, order, file, heading);
    }
  throw bad(file, "\"" + heading + "\": no numbers below; allowed: six rows of six numbers");
}

/// Reads stiffness, and behind it mass if there is one, as arrays of NumPy.
BladeStation read_anba(std::string text, const std::string& file) {
  for (char& letter : text)
    if (std::string("[](),").find(letter) != std::string::npos) letter = ' ';
  std::istringstream in(text);
  BladeStation station;
  station.stiffness = next_matrix(in, kAlongZ, file, "stiffness");
  if (!(in >> std::ws).eof()) station.mass = next_matrix(in, kAlongZ, file, "mass");
  if (!(in >> std::ws).eof()) throw bad(file, "more than two arrays; allowed: stiffness, and mass behind it");
  return station;
}

std::vector<BladeStation> read_beamdyn(const std::string& text, const std::string& file) {
  std::istringstream in(text);
  std::string line;
  int count = 0;
  while (std::getline(in, line) && line.find(kBeamDynTable) == std::string::npos)
    if (line.find("station_total") != std::string::npos) count = std::atoi(line.c_str());
  if (count < 2) throw bad(file, "station_total is missing or less than two");
  std::vector<BladeStation> stations(static_cast<std::size_t>(count));
  for (BladeStation& station : stations) {
    if (!(in >> station.position))
      throw bad(file, "ends before station " + std::to_string(&station - stations.data() + 1) + " of " +
                          std::to_string(count) + ", or has no number there");
    const std::string at = "station " + shortest(station.position);
    station.stiffness = next_matrix(in, kAlongZ, file, at + ", stiffness");
    station.mass = next_matrix(in, kAlongZ, file, at + ", mass");
  }
  return stations;
}

/// Matrix from the rows of its upper triangle, 21 numbers from `next` on.
Matrix6 matrix_of_triangle(const double* next) {
  Matrix6 matrix{};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = i; j < 6; ++j, ++next) matrix[kAlongZ[i]][kAlongZ[j]] = matrix[kAlongZ[j]][kAlongZ[i]] = *next;
  return matrix;
}

/// Mass matrix of a body with its centre at (x, y); `inertia`: about the axes through the reference point.
Matrix6 mass_about_axis(double mass, double x, double y, const Vector3& inertia, double product) {
  const double mx = mass * x, my = mass * y;
  const std::array<double, 21> triangle = {mass, 0,  0,   0, 0,          -my,      mass, 0,          0, 0,         mx,
                                           mass, my, -mx, 0, inertia[0], -product, 0,    inertia[1], 0, inertia[2]};
  return matrix_of_triangle(triangle.data());
}

/// Transforms `matrix`, about the point (x, y) and along axes rotated by `angle`, to the reference point and axes 2 and
/// 3: T^T M T, T of strains or velocities.
Matrix6 about_reference(const Matrix6& matrix, double x, double y, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const double t[6][6] = {{1, 0, 0, 0, y, -x},
                          {0, c, s, s * x - c * y, 0, 0},
                          {0, -s, c, s * y + c * x, 0, 0},
                          {0, 0, 0, 1, 0, 0},
                          {0, 0, 0, 0, c, s},
                          {0, 0, 0, 0, -s, c}};
  Matrix6 moved{};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j)
      for (std::size_t k = 0; k < 6; ++k)
        for (std::size_t l = 0; l < 6; ++l) moved[i][j] += t[k][i] * matrix[k][l] * t[l][j];
  return moved;
}

/// Station from r, m, x_cg, y_cg, ri_x, ri_y, then pitch, x_e, y_e and the triangle of a matrix (30 numbers), or x_sh,
/// y_sh, E, G, I_x, I_y, K, k_x, k_y, A, pitch, x_e, y_e (19). Torsion of the latter is about the shear centre; all
/// else, also radii of gyration, is about the elastic centre along axes rotated by the pitch.
BladeStation station_of_hawc2(const std::vector<double>& v) {
  const double* axes = &v[v.size() == 30 ? 6 : 16];
  const double angle = axes[0] * kPi / 180.0, c = std::cos(angle), s = std::sin(angle);
  const auto from_centre = [&](double x, double y) {
    return std::array{c * (x - axes[1]) + s * (y - axes[2]), c * (y - axes[2]) - s * (x - axes[1])};
  };
  std::array<double, 21> k{};
  if (v.size() == 30) {
    std::copy(v.begin() + 9, v.end(), k.begin());
  } else {
    const auto [x, y] = from_centre(v[6], v[7]);
    const double kx = v[9] * v[15] * v[13], ky = v[9] * v[15] * v[14], e = v[8];
    const double torsion = v[9] * v[12] + kx * y * y + ky * x * x;
    k = {kx, 0, 0, 0, 0, -kx * y, ky, 0, 0, 0, ky * x, e * v[15], 0, 0, 0, e * v[10], 0, 0, e * v[11], 0, torsion};
  }
  const auto [x, y] = from_centre(v[2], v[3]);
  const double jx = v[1] * v[4] * v[4], jy = v[1] * v[5] * v[5];
  const Matrix6 mass = mass_about_axis(v[1], x, y, {jx, jy, jx + jy}, 0.0);
  const auto moved = [&](const Matrix6& matrix) { return about_reference(matrix, axes[1], axes[2], angle); };
  return {0.0, moved(matrix_of_triangle(k.data())), moved(mass), 0.0, {0.0, 0.0, v[0]}};
}

/// Place of the next first table of a set of HAWC2, "$1" and the number of its rows.
std::size_t next_hawc2_set(const std::string& text, std::size_t from) {
  return std::min(text.find("\n$1 ", from), text.find("\n$1\t", from));
}

std::vector<BladeStation> read_hawc2(const std::string& text, const std::string& file) {
  const std::size_t table = next_hawc2_set(text, 0);
  if (next_hawc2_set(text, table + 1) != std::string::npos)
    throw bad(file, "several sets of tables (#1, #2, ...); allowed: one, that of the blade");
  std::istringstream in(text.substr(table + std::string("\n$1 ").size()));
  std::size_t count = 0;
  std::string line;
  in >> count;
  std::getline(in, line);
  std::vector<BladeStation> stations;
  while (stations.size() < count && std::getline(in, line)) {
    std::istringstream words(line);
    std::vector<double> row;
    for (double value = 0.0; words >> value;) row.push_back(value);
    if (!words.eof() || (row.size() != 19 && row.size() != 30))
      throw bad(file, "table $1: row " + std::to_string(stations.size() + 1) + " has " + std::to_string(row.size()) +
                          " numbers; allowed: 19, or 30 with a full matrix");
    stations.push_back(station_of_hawc2(row));
  }
  if (count < 2 || stations.size() < count || !(stations.front().place[2] < stations.back().place[2]))
    throw bad(file, "table $1: " + std::to_string(stations.size()) + " rows of " + std::to_string(count) +
                        "; allowed: all of them, two or more, from root to tip");
  for (BladeStation& station : stations) station.position = station.place[2] / stations.back().place[2];
  return stations;
}

/// Piecewise linear values over the grid of a WindIO file.
struct OverGrid {
  std::vector<double> grid{}, value{};

  double at(double x) const {
    const std::size_t i = static_cast<std::size_t>(std::upper_bound(grid.begin(), grid.end(), x) - grid.begin());
    if (i == 0) return value.front();
    if (i == grid.size()) return value.back();
    return value[i - 1] + (value[i] - value[i - 1]) * (x - grid[i - 1]) / (grid[i] - grid[i - 1]);
  }
};

class WindIo {
 public:
  explicit WindIo(const std::string& file) : file_(file) {}

  std::vector<BladeStation> stations(const std::string& text) const {
    try {
      const YAML::Node blade = need(need(YAML::Load(text), "components"), "blade");
      if (const YAML::Node first = blade["elastic_properties_mb"])
        return matrices_of_version_1(blade, need(first, "six_x_six"));
      const YAML::Node structure = blade["structure"];
      return matrices_of_version_2(
          blade, need(structure && structure["elastic_properties"] ? structure : blade, "elastic_properties"));
    } catch (const YAML::Exception& error) {
      throw bad(file_ + ":" + std::to_string(error.mark.line + 1), error.msg);
    }
  }

 private:
  YAML::Node need(const YAML::Node& parent, const std::string& name) const {
    const YAML::Node child = parent.IsMap() ? parent[name] : YAML::Node();
    if (!child) throw bad(file_, "\"" + name + "\" is missing: no elastic properties of a blade as WindIO writes them");
    return child;
  }

  OverGrid over_grid(const YAML::Node& node, const std::string& name) const {
    OverGrid read{need(node, "grid").as<std::vector<double>>(), need(node, "values").as<std::vector<double>>()};
    check_grid(read.grid, read.value.size(), name);
    return read;
  }
  void check_grid(const std::vector<double>& grid, std::size_t values, const std::string& name) const {
    if (grid.size() < 2 || grid.size() != values)
      throw bad(file_, "\"" + name + "\": " + std::to_string(grid.size()) + " places and " + std::to_string(values) +
                           " values; allowed: as many, two or more");
    for (std::size_t i = 0; i < grid.size(); ++i)
      if (!(grid[i] >= 0.0) || !(grid[i] <= 1.0) || (i > 0 && !(grid[i] > grid[i - 1])))
        throw bad(file_, "\"" + name + "\": grid has " + shortest(grid[i]) + "; allowed: ascending from 0 to 1");
  }

  /// Reads a coordinate with a grid of its own, or beside one for all.
  OverGrid coordinate(const YAML::Node& axis, const std::string& name) const {
    const YAML::Node node = need(axis, name);
    if (!node.IsSequence()) return over_grid(node, "reference_axis/" + name);
    OverGrid read{need(axis, "grid").as<std::vector<double>>(), node.as<std::vector<double>>()};
    check_grid(read.grid, read.value.size(), "reference_axis/" + name);
    return read;
  }

  /// Twist of WindIO is about -z: positive turns the leading edge towards the wind.
  void place_along(const YAML::Node& axis, const OverGrid& twist, double radians,
                   std::vector<BladeStation>& stations) const {
    const OverGrid x = coordinate(axis, "x"), y = coordinate(axis, "y"), z = coordinate(axis, "z");
    for (BladeStation& station : stations) {
      station.twist = -twist.at(station.position) * radians;
      station.place = {x.at(station.position), y.at(station.position), z.at(station.position)};
    }
  }

  /// Rows of the upper triangle, 21 numbers for each place.
  std::vector<Matrix6> triangles(const YAML::Node& node, const std::string& name, std::vector<double>& grid) const {
    grid = need(node, "grid").as<std::vector<double>>();
    const auto rows = need(node, "values").as<std::vector<std::vector<double>>>();
    check_grid(grid, rows.size(), name);
    std::vector<Matrix6> matrices;
    for (const std::vector<double>& row : rows) {
      if (row.size() != 21)
        throw bad(file_, "\"" + name + "\": " + std::to_string(row.size()) + " numbers at a place; allowed: 21");
      matrices.push_back(matrix_of_triangle(row.data()));
    }
    return matrices;
  }

  std::vector<BladeStation> matrices_of_version_1(const YAML::Node& blade, const YAML::Node& six) const {
    std::vector<double> grid, mass_grid;
    const std::vector<Matrix6> stiffness = triangles(need(six, "stiff_matrix"), "stiff_matrix", grid),
                               mass = triangles(need(six, "inertia_matrix"), "inertia_matrix", mass_grid);
    check_same(grid, mass_grid);
    std::vector<BladeStation> stations(grid.size());
    for (std::size_t i = 0; i < grid.size(); ++i) stations[i] = {grid[i], stiffness[i], mass[i]};
    const YAML::Node axis =
        six["reference_axis"] ? six["reference_axis"] : need(need(blade, "outer_shape_bem"), "reference_axis");
    const YAML::Node twist = six["twist"] ? six["twist"] : need(need(blade, "outer_shape_bem"), "twist");
    place_along(axis, over_grid(twist, "twist"), 1.0, stations);
    return stations;
  }

  void check_same(const std::vector<double>& grid, const std::vector<double>& other) const {
    bool same = grid.size() == other.size();
    for (std::size_t i = 0; same && i < grid.size(); ++i) same = std::abs(grid[i] - other[i]) <= kSamePlace;
    if (!same) throw bad(file_, "stiffness and mass matrices stand at other places; allowed: one grid for both");
  }

  std::vector<BladeStation> matrices_of_version_2(const YAML::Node& blade, const YAML::Node& elastic) const {
    const YAML::Node stiffness = need(elastic, "stiffness_matrix"), inertia = need(elastic, "inertia_matrix");
    const auto grid = need(stiffness, "grid").as<std::vector<double>>();
    check_same(grid, need(inertia, "grid").as<std::vector<double>>());
    const auto column = [&](const YAML::Node& node, const std::string& name) {
      auto values = need(node, name).as<std::vector<double>>();
      check_grid(grid, values.size(), name);
      return values;
    };
    std::vector<std::vector<double>> rows(grid.size());
    for (std::size_t i = 1; i <= 6; ++i)
      for (std::size_t j = i; j <= 6; ++j) {
        const auto entry = column(stiffness, "K" + std::to_string(i) + std::to_string(j));
        for (std::size_t s = 0; s < grid.size(); ++s) rows[s].push_back(entry[s]);
      }
    const auto mass = column(inertia, "mass"), cm_x = column(inertia, "cm_x"), cm_y = column(inertia, "cm_y"),
               edge = column(inertia, "i_edge"), flap = column(inertia, "i_flap"), polar = column(inertia, "i_plr"),
               product = column(inertia, "i_cp");
    std::vector<BladeStation> stations;
    for (std::size_t s = 0; s < grid.size(); ++s)
      stations.push_back({grid[s], matrix_of_triangle(rows[s].data()),
                          mass_about_axis(mass[s], cm_x[s], cm_y[s], {edge[s], flap[s], polar[s]}, product[s])});
    const YAML::Node outer = need(blade, "outer_shape");
    const YAML::Node axis = blade["reference_axis"] ? blade["reference_axis"] : need(elastic, "reference_axis");
    place_along(axis, over_grid(need(outer, "twist"), "twist"), kPi / 180.0, stations);
    return stations;
  }

  std::string file_;
};

/// Replaces a matrix by the mean of both triangles.
void make_symmetric(Matrix6& matrix, const std::string& what, const std::string& file) {
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double unit = std::sqrt(std::abs(matrix[i][i] * matrix[j][j]));
      if (!(std::abs(matrix[i][j] - matrix[j][i]) <= kAsymmetry * unit))
        throw bad(file, what + " is not symmetric: " + shortest(matrix[i][j]) + " across the diagonal from " +
                            shortest(matrix[j][i]));
      matrix[i][j] = matrix[j][i] = 0.5 * (matrix[i][j] + matrix[j][i]);
    }
}

/// Sets mass, centre of mass, and moments of inertia about axes through it.
void set_mass(const Matrix6& m, const std::string& file, Teuchos::ParameterList& section) {
  const double mass = m[0][0];
  if (mass == 0.0) return;
  const double c2 = -m[0][5] / mass, c3 = m[0][4] / mass;
  const double j2 = m[4][4] - mass * c3 * c3, j3 = m[5][5] - mass * c2 * c2, product = -m[4][5] - mass * c2 * c3;
  double j1 = m[3][3] - mass * (c2 * c2 + c3 * c3);
  if (std::abs(j1 - j2 - j3) <= kRoundedPolar * m[3][3]) j1 = j2 + j3;
  if (!(mass > 0.0) || !(j2 >= 0.0) || !(j3 >= 0.0) || !(j1 >= 0.0) || !(j1 <= j2 + j3) ||
      !(product * product <= j2 * j3))
    throw bad(file, "mass matrix with the diagonal " + shortest(mass) + ", " + shortest(m[3][3]) + ", " +
                        shortest(m[4][4]) + ", " + shortest(m[5][5]) +
                        " (mass, moments of inertia about axes 1, 2, 3), which no section has");
  section.set("Mass", mass);
  section.set("Mass Offset", Teuchos::Array<double>(Teuchos::tuple(c2, c3)));
  section.set("Rotary Inertia", Teuchos::Array<double>(Teuchos::tuple(j1, j2, j3)));
  section.set("Inertia Product", product);
}

Teuchos::ParameterList section_of(BladeStation station, const std::string& file) {
  make_symmetric(station.stiffness, "stiffness matrix", file);
  make_symmetric(station.mass, "mass matrix", file);
  Teuchos::ParameterList section;
  Teuchos::Array<double> triangle;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = i; j < 6; ++j) triangle.push_back(station.stiffness[i][j]);
  section.set("Matrix", triangle);
  set_mass(station.mass, file, section);
  return section;
}

struct NamedStation {
  std::string name, file;
  BladeStation station;
};

/// Sets positions along the line from the first station to the last, and offsets from it.
void set_stations(const std::vector<NamedStation>& all, Teuchos::ParameterList& list) {
  Teuchos::Array<double> position, twist, offset2, offset3;
  Teuchos::Array<std::string> names;
  const Vector3 &root = all.front().station.place, &tip = all.back().station.place;
  const Vector3 line = difference(tip, root);
  const bool has_axis = dot(line, line) > 0.0;
  const Vector3 along = has_axis ? unit(line) : Vector3{0.0, 0.0, 1.0};
  const Vector3 axis2 = unit({1.0 - along[0] * along[0], -along[0] * along[1], -along[0] * along[2]});
  const Vector3 axis3 = cross(along, axis2);
  for (const NamedStation& at : all) {
    const Vector3 from = difference(at.station.place, root);
    position.push_back(&at == &all.back() ? 1.0
                       : has_axis         ? dot(from, along) / std::sqrt(dot(line, line))
                                          : at.station.position);
    twist.push_back(at.station.twist);
    offset2.push_back(has_axis ? dot(from, axis2) : 0.0);
    offset3.push_back(has_axis ? dot(from, axis3) : 0.0);
    names.push_back(at.name);
  }
  list.set("Position", position);
  list.set("Section", names);
  const auto set_where_used = [&](const std::string& name, const Teuchos::Array<double>& values) {
    if (std::any_of(values.begin(), values.end(), [](double value) { return value != 0.0; })) list.set(name, values);
  };
  set_where_used("Twist", twist);
  set_where_used("Offset 2", offset2);
  set_where_used("Offset 3", offset3);
}

std::vector<std::string> names_of_stations(std::size_t count, const std::string& file) {
  if (count == 1) return {std::filesystem::path(file).stem().string()};
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= count; ++i) names.push_back("station " + std::to_string(i));
  return names;
}

/// Sections of all files in turn, with names that differ. Returns their format.
BladeFormat read_all(const std::vector<std::string>& files, std::vector<NamedStation>& all) {
  BladeFormat format = BladeFormat::none;
  for (const std::string& file : files) {
    const std::string text = text_of_file(file, "a file with matrices of sections");
    const std::vector<BladeStation> stations = read_blade(text, file);
    const std::vector<std::string> names = names_of_stations(stations.size(), file);
    if (files.size() > 1 && (stations.size() > 1 || (!all.empty() && blade_format(text) != format)))
      throw bad(file, "more than one section, or another format than " + files.front() +
                          "; allowed: several files only of one section each, of one format");
    format = blade_format(text);
    for (std::size_t i = 0; i < stations.size(); ++i) {
      for (const NamedStation& other : all)
        if (other.name == names[i])
          throw bad(file, "a second file called \"" + names[i] + "\"; allowed: names that differ");
      all.push_back({names[i], file, stations[i]});
    }
  }
  for (std::size_t i = 0; files.size() > 1 && i < all.size(); ++i)
    all[i].station.position = static_cast<double>(i) / static_cast<double>(all.size() - 1);
  return format;
}

}  // namespace

BladeFormat blade_format(const std::string& text) {
  const auto has = [&](const char* words) { return text.find(words) != std::string::npos; };
  if (has(kVabsStiffness)) return BladeFormat::vabs;
  if (has(kBecasStiffness)) return BladeFormat::becas;
  if (has("station_total") && has(kBeamDynTable)) return BladeFormat::beamdyn;
  if (has("components:") && has("blade:") && has("elastic_properties")) return BladeFormat::windio;
  if (next_hawc2_set(text, 0) != std::string::npos) return BladeFormat::hawc2;
  const bool is_of_numbers = text.find_first_not_of(kPrintedArray) == std::string::npos;
  if (is_of_numbers && text.find_first_of("0123456789") != std::string::npos) return BladeFormat::anba;
  return BladeFormat::none;
}

std::vector<BladeStation> read_blade(const std::string& text, const std::string& file) {
  switch (blade_format(text)) {
    case BladeFormat::vabs:
      return {{0.0, matrix_below(text, kVabsStiffness, kAlongX, file), matrix_below(text, kVabsMass, kAlongX, file)}};
    case BladeFormat::becas:
      return {{0.0, matrix_below(text, kBecasStiffness, kAlongZ, file), matrix_below(text, kBecasMass, kAlongZ, file)}};
    case BladeFormat::beamdyn:
      return read_beamdyn(text, file);
    case BladeFormat::windio:
      return WindIo(file).stations(text);
    case BladeFormat::hawc2:
      return read_hawc2(text, file);
    case BladeFormat::anba:
      return {read_anba(text, file)};
    case BladeFormat::none:
      break;
  }
  throw bad(file,
            "no matrices of sections; allowed: VABS (NAME.K), BECAS (NAME.out), arrays of ANBA4, blade file of "
            "BeamDyn, WindIO, st file of HAWC2");
}

Teuchos::ParameterList sections_of_blade(const std::string& text, const std::string& file) {
  const std::vector<BladeStation> stations = read_blade(text, file);
  const std::vector<std::string> names = names_of_stations(stations.size(), file);
  Teuchos::ParameterList sections;
  for (std::size_t i = 0; i < stations.size(); ++i) sections.sublist(names[i]) = section_of(stations[i], file);
  return sections;
}

Teuchos::ParameterList scene_of_blades(const std::vector<std::string>& files, std::vector<std::string>& remarks) {
  std::vector<NamedStation> all;
  const BladeFormat format = read_all(files, all);
  if (files.size() > 1)
    remarks.emplace_back("the files do not tell where their sections are: they are equally spaced; see Position");
  const bool along_x = format == BladeFormat::vabs;
  const bool has_axis = format == BladeFormat::windio || format == BladeFormat::hawc2;
  Teuchos::ParameterList root("blade");
  Teuchos::ParameterList& scene = root.sublist("Scene");
  if (!has_axis) {
    scene.sublist("Variables").set("L", 1.0);
    remarks.emplace_back("the length is not in the file: the variable L is 1");
  }
  for (const NamedStation& at : all) scene.sublist("Sections").sublist(at.name) = section_of(at.station, at.file);
  const Vector3 &start = all.front().station.place, &end = all.back().station.place;
  Teuchos::ParameterList& points = scene.sublist("Points");
  points.set("root", Teuchos::Array<double>(start.begin(), start.end()));
  if (has_axis)
    points.set("tip", Teuchos::Array<double>(end.begin(), end.end()));
  else
    points.set("tip", Teuchos::Array<std::string>(
                          Teuchos::tuple<std::string>(along_x ? "=L" : "0", "0", along_x ? "0" : "=L")));
  Teuchos::ParameterList& member = scene.sublist("Members").sublist("blade");
  member.set("Start", "root");
  member.set("End", "tip");
  member.set("Second Axis",
             Teuchos::Array<double>(along_x ? Teuchos::tuple(0.0, 1.0, 0.0) : Teuchos::tuple(1.0, 0.0, 0.0)));
  if (all.size() == 1)
    member.set("Section", all.front().name);
  else
    set_stations(all, member.sublist("Section Stations"));
  scene.sublist("Supports").sublist("root").set("Point", "root");
  return root;
}

}  // namespace mixbeam
