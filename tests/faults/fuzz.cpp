// What reads the input, for libFuzzer: whatever the bytes, a reader ends with a result or with an InputError.
// Compiled once for each value of FUZZ_TARGET by fuzz.sh.
#include "apps/mixbeam/batch_cases.hpp"
#include "discretization/checks/expected_values.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/results/records.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/expression.hpp"

#include <unistd.h>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>

namespace {

using namespace mixbeam;

/// Parts of an input: the text of a scene, then that of a table.
const std::string kSeparator = "\n=====\n";

[[maybe_unused]] std::pair<std::string, std::string> parts(const std::string& text) {
  const std::size_t place = text.find(kSeparator);
  if (place == std::string::npos) return {text, ""};
  return {text.substr(0, place), text.substr(place + kSeparator.size())};
}

[[maybe_unused]] ListSpec spec_of_file() {
  ListSpec root("fuzz");
  root.add_list("Scene", scene_spec(), Presence::required);
  root.add_list("Expected", expected_values_spec(), Presence::defaulted);
  return root;
}

/// As `mixbeam check` reads a scene, up to the mesh.
[[maybe_unused]] void read_file(XmlParameters xml) {
  for (const char* other : {"Solver", "Analysis", "Batch", "Study"}) xml.list->remove(other, false);
  validate(*xml.list, spec_of_file(), xml.source);
  const Scene scene = read_scene(xml.list->sublist("Scene"), xml.source);
  check_expected_values(read_expected_values(xml.list->sublist("Expected"), xml.source), scene, xml.source);
}

[[maybe_unused]] void scene(const std::string& text) { read_file(parse_xml(text, "scene.xml")); }

[[maybe_unused]] void yaml(const std::string& text) { read_file(parse_yaml(text, "scene.yaml", spec_of_file())); }

/// The tables of a scene that is in order.
[[maybe_unused]] void table(const std::string& text) {
  XmlParameters xml = parse_xml(R"(<ParameterList name="t"><ParameterList name="Scene">
    <ParameterList name="Sections"><ParameterList name="s"><Parameter name="EA" type="double" value="1"/>
      <Parameter name="Shear Rigid" type="bool" value="true"/><Parameter name="GIt" type="double" value="1"/>
      <Parameter name="EI2" type="double" value="1"/><Parameter name="EI3" type="double" value="1"/></ParameterList></ParameterList>
    <ParameterList name="Import"><Parameter name="Points File" type="string" value="p"/>
      <Parameter name="Members File" type="string" value="m"/></ParameterList>
    <ParameterList name="Supports"><ParameterList name="c"><Parameter name="Point" type="string" value="*"/></ParameterList></ParameterList>
    </ParameterList></ParameterList>)",
                                "scene.xml");
  const auto [points, members] = parts(text);
  xml.source.set_files({{"p", points}, {"m", members}});
  read_file(xml);
}

[[maybe_unused]] void formula(const std::string& text) {
  try {
    const Expression expression(text, {"x", "s"});
    for (const double x : {0.0, 0.5, -1.0, 1e300, std::nan("")}) expression({x, 2.0});
  } catch (const std::invalid_argument&) {  // what readers of scenes turn into an InputError
  }
}

/// The table of a batch comes from the disk.
[[maybe_unused]] void batch(const std::string& text) {
  static const std::string folder = [] {
    std::string name = "/tmp/mixbeam_fuzz_XXXXXX";
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    return name;
  }();
  const auto [xml_text, table] = parts(text);
  std::ofstream(folder + "/table.csv", std::ios::binary) << table;
  XmlParameters xml = parse_xml(xml_text, folder + "/batch.xml");
  ListSpec root("fuzz");
  root.add_list("Batch", batch_spec(), Presence::required);
  validate(*xml.list, root, xml.source);
  const Batch batch = read_batch(xml.list->sublist("Batch"), xml.source);
  for (std::size_t i = 0; i < batch.size(); ++i) batch.name_of_case(i);
}

#ifdef FUZZ_RESULTS
// Result files: a real one ($FUZZ_RESULT) is forged as the bytes say (links, types, shapes, places, values), sealed or
// not, and read. What another file holds, which links and external storage lead to, must not be found in what is read.
// $FUZZ_KEEP: the forged file stays there, to be given to the commands; $FUZZ_FLIPS: single bytes are changed too,
// which the library may not survive.
const std::string kForeign = "FOREIGN!";
constexpr std::size_t kLargestForged = 1 << 20;  // bytes of values that are written: memory and time go to readers

/// Choices that the input makes.
class Choices {
 public:
  explicit Choices(const std::string& bytes) : engine_(std::hash<std::string>()(bytes)) {}
  std::size_t below(std::size_t count) { return count == 0 ? 0 : engine_() % count; }
  template <class List>
  auto of(const List& list) {
    return *(std::begin(list) + below(std::size(list)));
  }

 private:
  std::mt19937_64 engine_;
};

struct Thing {
  std::string parent, name;
  bool is_attribute = false, is_group = false;
  std::string path() const { return parent == "/" ? "/" + name : parent + "/" + name; }
};

std::vector<Thing> things_in(hid_t file) {
  std::vector<Thing> things;
  const auto add = [](hid_t object, const char* name, const H5O_info_t* info, void* all) -> herr_t {
    auto& list = *static_cast<std::vector<Thing>*>(all);
    const std::string path = std::string(name) == "." ? "/" : "/" + std::string(name);
    const std::size_t slash = path.rfind('/');
    if (path != "/")
      list.push_back(
          {slash == 0 ? "/" : path.substr(0, slash), path.substr(slash + 1), false, info->type == H5O_TYPE_GROUP});
    const hdf5::Handle id(H5Oopen(object, name, H5P_DEFAULT), H5Oclose, "open");
    for (const std::string& attribute : hdf5::attribute_names(id)) list.push_back({path, attribute, true});
    return 0;
  };
  H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, add, &things, H5O_INFO_BASIC);
  return things;
}

hid_t odd_type(Choices& choose, hid_t file) {
  const hid_t text = H5Tcopy(H5T_C_S1), compound = H5Tcreate(H5T_COMPOUND, 16);
  H5Tinsert(compound, "a", 0, H5T_NATIVE_DOUBLE);
  const hsize_t three = 3;
  switch (choose.below(12)) {
    case 0:
      H5Tset_size(text, H5T_VARIABLE);
      return text;
    case 1:
      H5Tset_size(text, 1 + choose.below(5000));
      return text;
    case 2:
      return compound;
    case 3:
      return H5Tarray_create2(H5T_IEEE_F64LE, 1, &three);
    case 4:
      return H5Tvlen_create(H5T_IEEE_F64LE);
    case 5:
      return H5Tcreate(H5T_OPAQUE, 1 + choose.below(100));
    case 6:
      H5Tinsert(compound, "b", 8, H5T_STD_I64BE);
      return compound;
    case 7: {
      const hid_t named = H5Tcopy(choose.below(2) ? H5T_IEEE_F64LE : H5T_STD_I32LE);
      H5Tcommit2(file, ("type" + std::to_string(choose.below(1000))).c_str(), named, H5P_DEFAULT, H5P_DEFAULT,
                 H5P_DEFAULT);
      return named;
    }
    case 8:
      return H5Tenum_create(H5T_STD_I32LE);
    default: {
      const hid_t plain[] = {H5T_STD_I32LE, H5T_IEEE_F64LE, H5T_IEEE_F64BE,  H5T_IEEE_F32LE,
                             H5T_STD_I8LE,  H5T_STD_U64LE,  H5T_STD_REF_OBJ, H5T_STD_B64LE};
      return H5Tcopy(choose.of(plain));
    }
  }
}

hid_t odd_space(Choices& choose, bool may_be_huge) {
  if (choose.below(5) == 0) return H5Screate(H5S_SCALAR);
  if (choose.below(10) == 0) return H5Screate(H5S_NULL);
  std::vector<hsize_t> shape(1 + choose.below(3));
  const hsize_t sizes[] = {0, 1, 2, 3, 4, 5, 6, 9, 64, 400};
  for (hsize_t& size : shape) size = choose.of(sizes);
  if (may_be_huge) shape[0] = hsize_t{1} << (20 + choose.below(40));
  return H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
}

hid_t odd_storage(Choices& choose, hid_t space, hid_t type, const std::string& foreign) {
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  const int rank = H5Sget_simple_extent_ndims(space);
  const std::vector<hsize_t> chunk(std::max(1, rank), 4);
  switch (choose.below(7)) {
    case 0:
      H5Pset_layout(creation, H5D_COMPACT);
      break;
    case 1:
      H5Pset_external(creation, foreign.c_str(), 0, H5F_UNLIMITED);
      break;
    case 2:
      H5Pset_chunk(creation, rank, chunk.data());
      if (choose.below(2)) H5Pset_deflate(creation, 1);
      if (choose.below(3) == 0) H5Pset_fletcher32(creation);
      break;
    case 3:
      H5Pset_virtual(creation, space, (foreign + ".h5").c_str(), "x", space);
      break;
    case 4: {
      const double fill[64] = {1.0};
      if (H5Tget_class(type) == H5T_FLOAT) H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, fill);
      break;
    }
    default:
      break;
  }
  return creation;
}

void replace_by_odd_values(hid_t file, const Thing& thing, Choices& choose, const std::string& foreign) {
  const hid_t parent = H5Oopen(file, thing.parent.c_str(), H5P_DEFAULT), type = odd_type(choose, file);
  const bool may_be_huge = !thing.is_attribute && choose.below(10) == 0;
  const hid_t space = odd_space(choose, may_be_huge);
  const auto points = static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space)));
  const bool is_huge = may_be_huge || points * H5Tget_size(type) > kLargestForged;
  const std::vector<char> bytes(is_huge ? 0 : 4096 + points * H5Tget_size(type), 'x');
  const bool has_pointers =
      H5Tdetect_class(type, H5T_VLEN) > 0 || H5Tis_variable_str(type) > 0 || H5Tget_class(type) == H5T_REFERENCE;
  if (thing.is_attribute) {
    H5Adelete(parent, thing.name.c_str());
    const hid_t id = H5Acreate2(parent, thing.name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (!has_pointers && !is_huge && id >= 0) H5Awrite(id, type, bytes.data());
    H5Aclose(id);
  } else {
    H5Ldelete(parent, thing.name.c_str(), H5P_DEFAULT);
    const hid_t creation = odd_storage(choose, space, type, foreign);
    const hid_t id = H5Dcreate2(parent, thing.name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    H5D_layout_t layout = H5Pget_layout(creation);
    if (id >= 0 && !is_huge && !has_pointers && H5Pget_external_count(creation) == 0 && layout != H5D_VIRTUAL &&
        choose.below(4))
      H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
    H5Dclose(id);
    H5Pclose(creation);
  }
  H5Oclose(parent);
}

void replace_by_link(hid_t file, const Thing& thing, const std::vector<Thing>& things, Choices& choose,
                     const std::string& foreign) {
  if (thing.is_attribute) return;
  const std::string path = thing.path(), other = choose.below(3) == 0 ? std::string("/") : choose.of(things).path();
  const bool stays = choose.below(3) == 0;
  const std::string name = stays ? path + "x" : path;
  if (!stays && choose.below(2)) H5Ldelete(file, path.c_str(), H5P_DEFAULT);
  switch (choose.below(4)) {
    case 0:
      H5Ldelete(file, name.c_str(), H5P_DEFAULT);
      H5Lcreate_soft(other.c_str(), file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      break;
    case 1:
      H5Ldelete(file, name.c_str(), H5P_DEFAULT);
      H5Lcreate_external((foreign + ".h5").c_str(), choose.below(2) ? "/" : "x", file, name.c_str(), H5P_DEFAULT,
                         H5P_DEFAULT);
      break;
    case 2:
      H5Lcreate_hard(file, other.c_str(), file, (path + "y").c_str(), H5P_DEFAULT, H5P_DEFAULT);
      break;
    default: {
      std::string deep = thing.is_group ? path : std::string("/polyline");
      for (std::size_t i = choose.below(300); i > 0; --i)
        H5Gclose(H5Gcreate2(file, (deep += "/d").c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    }
  }
}

void change_values(hid_t file, const Thing& thing, Choices& choose) {
  const double odd[] = {std::nan(""), INFINITY,     -INFINITY,     1e308, -1.0, 0.0,
                        1e-320,       2147483647.0, -2147483648.0, 1e18,  3.0};
  const hid_t id = thing.is_attribute
                       ? H5Aopen_by_name(file, thing.parent.c_str(), thing.name.c_str(), H5P_DEFAULT, H5P_DEFAULT)
                       : H5Dopen2(file, thing.path().c_str(), H5P_DEFAULT);
  if (id < 0) return;
  const hid_t type = thing.is_attribute ? H5Aget_type(id) : H5Dget_type(id),
              space = thing.is_attribute ? H5Aget_space(id) : H5Dget_space(id);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 && count >= 0 && count < 100000) {
    std::string bytes(static_cast<std::size_t>(count) * H5Tget_size(type) + 1, static_cast<char>(choose.below(256)));
    thing.is_attribute ? H5Awrite(id, type, bytes.data())
                       : H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
  } else if (count >= 0 && count < 100000 && (H5Tget_class(type) == H5T_FLOAT || H5Tget_class(type) == H5T_INTEGER)) {
    std::vector<double> numbers(static_cast<std::size_t>(count) + 1);
    thing.is_attribute ? H5Aread(id, H5T_NATIVE_DOUBLE, numbers.data())
                       : H5Dread(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
    numbers[choose.below(static_cast<std::size_t>(count))] = choose.of(odd);
    thing.is_attribute ? H5Awrite(id, H5T_NATIVE_DOUBLE, numbers.data())
                       : H5Dwrite(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
  }
  const hsize_t rows[3] = {choose.below(4) == 0 ? hsize_t{1} << choose.below(62) : choose.below(30), 1, 1};
  if (!thing.is_attribute && choose.below(3) == 0) H5Dset_extent(id, rows);
  thing.is_attribute ? H5Aclose(id) : H5Dclose(id);
}

void forge(const std::string& path, Choices& choose, const std::string& foreign) {
  const hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make properties");
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);  // with all types that were left open
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
  if (file < 0) throw std::runtime_error("cannot open " + path);
  static const std::vector<Thing> things = things_in(file);  // each begins as the same file
  for (std::size_t changes = 1 + choose.below(3); changes > 0; --changes) {
    const Thing thing = choose.of(things);
    switch (choose.below(5)) {
      case 0:
        replace_by_odd_values(file, thing, choose, foreign);
        break;
      case 1:
        replace_by_link(file, thing, things, choose, foreign);
        break;
      case 2:
        change_values(file, thing, choose);
        break;
      case 3:
        thing.is_attribute ? H5Adelete_by_name(file, thing.parent.c_str(), thing.name.c_str(), H5P_DEFAULT)
                           : H5Ldelete(file, thing.path().c_str(), H5P_DEFAULT);
        break;
      default: {
        const Thing other = choose.of(things);  // under a name that it has not
        const std::string names[] = {"/steps/abc", "/steps/-1", "/steps/999999999", "/steps/000001x", "/monitor/z",
                                     "/members/0", "/x",        "/imported/0"};
        if (!other.is_attribute)
          H5Ocopy(file, other.path().c_str(), file, choose.of(names).c_str(), H5P_DEFAULT, H5P_DEFAULT);
      }
    }
  }
  const bool loses_seal = choose.below(4) == 0;
  if (loses_seal) {
    const hid_t version = H5Aopen(file, "format_version", H5P_DEFAULT);
    const int before_seals = 2;
    H5Awrite(version, H5T_NATIVE_INT, &before_seals);
    H5Aclose(version);
  }
  H5Fclose(file);
  DiskFile disk(path, DiskAccess::write);
  for (std::size_t flips = std::getenv("FUZZ_FLIPS") == nullptr ? 0 : choose.below(4); flips > 0; --flips) {
    char byte = static_cast<char>(choose.below(256));
    disk.write(choose.below(disk.size()), &byte, 1);
  }
  if (!loses_seal) write_seal(disk, seal_of(disk, disk.size(), kSmallBlock));
}

void require_own(const std::string& text) {
  if (text.find(kForeign) != std::string::npos) throw std::runtime_error("bytes of another file were read");
}

/// As resuming does. A file that verifying refuses is not copied: no command does.
void read_forged(const std::string& path, bool is_whole) {
  const StoredRun run(path);
  for (const auto& [name, text] : run.header().properties) require_own(text);
  for (const auto& [name, text] : run.header().imported) require_own(text);
  require_own(run.header().scene_xml + run.header().scene_name + run.header().version);
  const auto require_own_numbers = [](const std::vector<double>& numbers) {
    require_own({reinterpret_cast<const char*>(numbers.data()), 8 * numbers.size()});
  };
  for (const MonitoredSeries& series : run.monitor()) require_own_numbers(series.values);
  for (std::size_t i = 0; i < run.steps().size(); ++i) {
    require_own_numbers(run.state(i).interior);
    run.critical_points(i);
    run.jump(i);
  }
  if (!is_whole) return;
  SealedFile stored(path);
  const hdf5::QuietScope quiet;
  const hdf5::File source(stored.content(), hdf5::FileUse::read);
  DiskFile copy(path + ".copy", DiskAccess::create);
  Seal seal;
  GuardedFile content(copy, seal);
  hdf5::File target(content, hdf5::FileUse::create);
  copy_steps(source, target, run.steps().size(), run.monitor());
  target.close();
  content.flush();
  std::string bytes(copy.size(), '\0');
  copy.read(0, bytes.data(), bytes.size());
  require_own(bytes);
}

void results(const std::string& bytes) {
  static const std::string folder = [] {
    std::string name = "/dev/shm/mixbeam_fuzz_XXXXXX";
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    std::ofstream secret(name + "/secret", std::ios::binary);
    for (int i = 0; i < 100000; ++i) secret << kForeign;
    secret.close();
    const hdf5::QuietScope first_use;
    H5set_free_list_limits(-1, -1, -1, -1, -1, -1);  // the library keeps what it frees: most of the time was malloc's
    const hid_t file = H5Fcreate((name + "/secret.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    hdf5::write_text(file, "x", kForeign);
    hdf5::write_attribute(file, "a", kForeign);
    H5Fclose(file);
    return name;
  }();
  const hdf5::QuietScope quiet;
  const std::string path = std::getenv("FUZZ_KEEP") != nullptr ? std::getenv("FUZZ_KEEP") : folder + "/forged.h5";
  std::filesystem::copy_file(std::getenv("FUZZ_RESULT"), path, std::filesystem::copy_options::overwrite_existing);
  Choices choose(bytes);
  forge(path, choose, folder + "/secret");
  if (std::getenv("FUZZ_KEEP") != nullptr) return;
  static long whole = 0, all = 0;
  const bool is_whole = verify_results(path).damage.empty();
  whole += is_whole ? 1 : 0;
  if (++all % 2000 == 0) std::cerr << whole << " of " << all << " forged files pass for whole ones\n";
  try {
    read_forged(path, is_whole);
  } catch (const hdf5::Error&) {
    if (is_whole) throw;  // verifying says so before
  }
}
#endif

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    FUZZ_TARGET(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const InputError&) {  // any other exception ends the program: libFuzzer keeps the input
  }
  return 0;
}
