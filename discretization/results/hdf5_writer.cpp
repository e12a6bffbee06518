#include "discretization/results/hdf5_writer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace mixbeam::hdf5 {
namespace {

constexpr hsize_t kTableChunk = 16;  // rows and columns
constexpr double kMissing = NAN;
constexpr hsize_t kMonitorChunkRows = 64;  // 512 bytes a column: small for short runs, few chunks for long ones

// Called from the innermost error outwards: keeps the first description, which is the cause. Some failed allocations do
// not say of what.
herr_t keep_innermost(unsigned depth, const H5E_error2_t* error, void* reason) {
  if (depth != 0 || error->desc == nullptr) return 0;
  std::string& text = *static_cast<std::string*>(reason);
  text = error->desc;
  const bool is_allocation = error->min_num == H5E_CANTALLOC || error->min_num == H5E_NOSPACE;
  if (is_allocation && text.find("memory") == std::string::npos && text.find("file") == std::string::npos)
    text += ", no memory is left";
  return 0;
}

// The library's texts for failed system calls end in numbers useless to a user; keeps the system's own message.
std::string system_message(const std::string& reason) {
  const std::string key = "error message = '";
  const auto start = reason.find(key);
  if (start == std::string::npos) return reason;
  const auto end = reason.find('\'', start + key.size());
  return end == std::string::npos ? reason : reason.substr(start + key.size(), end - start - key.size());
}

[[noreturn]] void fail(const std::string& action) {
  std::string reason = "no reason given by the HDF5 library";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &reason);
  throw Error("cannot " + action + ": " + system_message(reason));
}

[[noreturn]] void refuse(const std::string& action, const std::string& reason) {
  throw Error("cannot " + action + ": " + reason);
}

Handle text_type(const std::string& text) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a text type");
  require(H5Tset_size(type, text.empty() ? 1 : text.size()), "size a text type");
  require(H5Tset_strpad(type, H5T_STR_NULLPAD), "pad a text type");
  require(H5Tset_cset(type, H5T_CSET_UTF8), "mark a text type as UTF-8");
  return type;
}

Handle scalar_space() { return {H5Screate(H5S_SCALAR), H5Sclose, "make a scalar space"}; }

void write_scalar_attribute(hid_t object, const std::string& name, hid_t file_type, hid_t memory_type,
                            const void* value) {
  const std::string action = "write attribute " + name;
  const Handle space = scalar_space();
  const Handle attribute(H5Acreate2(object, name.c_str(), file_type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         action);
  require(H5Awrite(attribute, memory_type, value), action);
}

/// Properties without the time at which the dataset was made: the same results are the same bytes.
Handle dataset_creation() {
  Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make properties of a dataset");
  require(H5Pset_obj_track_times(creation, false), "make properties of a dataset");
  return creation;
}

void write_array(hid_t group, const std::string& name, const std::vector<hsize_t>& shape, hid_t file_type,
                 hid_t memory_type, const void* values) {
  const std::string action = "write dataset " + name;
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, action);
  const Handle dataset(H5Dcreate2(group, name.c_str(), file_type, space, H5P_DEFAULT, dataset_creation(), H5P_DEFAULT),
                       H5Dclose, action);
  require(H5Dwrite(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), action);
}

Handle create_extendible(hid_t group, const std::string& name, std::vector<hsize_t> shape) {
  const std::string action = "create time series " + name;
  const int rank = static_cast<int>(shape.size());
  shape[0] = kMonitorChunkRows;
  const Handle creation = dataset_creation();
  require(H5Pset_chunk(creation, rank, shape.data()), action);
  std::vector<hsize_t> limits = shape;
  shape[0] = 0;
  limits[0] = H5S_UNLIMITED;
  const Handle space(H5Screate_simple(rank, shape.data(), limits.data()), H5Sclose, action);
  return {H5Dcreate2(group, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose, action};
}

constexpr const char* kLeavesFile = "it is a link that may leave the file; results have none";

/// Refuses names with a slash, which lead through links.
void require_plain_name(const std::string& name, const std::string& action) {
  if (name.empty() || name == "." || name.find('/') != std::string::npos)
    refuse(action, "its name is not one that results have");
}

/// Refuses links of other kinds, which may lead out of the file.
void require_hard_link(hid_t parent, const std::string& name, const std::string& action) {
  require_plain_name(name, action);
  H5L_info_t link{};
  require(H5Lget_info(parent, name.c_str(), &link, H5P_DEFAULT), action);
  if (link.type != H5L_TYPE_HARD) refuse(action, kLeavesFile);
}

/// Bytes of a value; refuses types other than the declared ones.
std::size_t width_of(hid_t type, Stored declared, const std::string& action) {
  Stored found = Stored::texts;
  bool is_written = false;
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
      found = Stored::integers;
      is_written = H5Tequal(type, H5T_STD_I32LE) > 0;
      break;
    case H5T_FLOAT:
      found = Stored::reals;
      is_written = H5Tequal(type, H5T_IEEE_F64LE) > 0;
      break;
    case H5T_STRING:
      is_written = H5Tis_variable_str(type) == 0;
      break;
    default:
      break;
  }
  const std::size_t width = H5Tget_size(type);
  const bool is_declared = (static_cast<unsigned>(found) & static_cast<unsigned>(declared)) != 0;
  if (!is_written || !is_declared || H5Tcommitted(type) != 0 || width == 0)
    refuse(action, "its type is not the one that it has in results");
  return width;
}

/// Requires values in this very file, without filters.
void require_plain_storage(hid_t dataset, const std::string& action) {
  if (H5Dget_offset(dataset) != HADDR_UNDEF) return;  // in one piece
  const Handle creation(H5Dget_create_plist(dataset), H5Pclose, action);
  const H5D_layout_t layout = H5Pget_layout(creation);
  const bool lies_here = layout == H5D_CONTIGUOUS || layout == H5D_CHUNKED || layout == H5D_COMPACT;
  if (!lies_here || H5Pget_external_count(creation) != 0) refuse(action, "its values lie in another file");
  if (H5Pget_nfilters(creation) != 0) refuse(action, "its storage is not the one that results have");
}

/// Determines shape and size; refuses values larger than the file.
void measure(StoredValues& values, Stored declared, const std::string& action) {
  constexpr hsize_t kSmall = 65536;  // whatever the file has
  const H5S_class_t kind = H5Sget_simple_extent_type(values.space);
  const int rank = H5Sget_simple_extent_ndims(values.space);
  constexpr int kHighestRank = 2;
  if ((kind != H5S_SCALAR && kind != H5S_SIMPLE) || rank < 0 || rank > kHighestRank)
    refuse(action, "its shape is not one that results have");
  values.shape.resize(static_cast<std::size_t>(rank));
  if (rank > 0) require(H5Sget_simple_extent_dims(values.space, values.shape.data(), nullptr), action);
  const std::size_t width = width_of(values.type, declared, action);
  const auto fits = [&](hsize_t room) {
    room /= width;
    for (const hsize_t size : values.shape) room /= std::max<hsize_t>(1, size);
    return room > 0;
  };
  hsize_t of_file = 0;
  if (!fits(kSmall)) {
    const Handle file(H5Iget_file_id(values.id), H5Fclose, action);
    require(H5Fget_filesize(file, &of_file), action);
  }
  if (!fits(std::max(kSmall, of_file))) refuse(action, "it is larger than the file");
  values.bytes = width;
  for (const hsize_t size : values.shape) values.bytes *= size;
}

std::string bytes_of(const StoredValues& stored, const std::string& action) {
  std::string bytes(stored.bytes, '\0');
  require(H5Dread(stored.id, stored.type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), action);
  return bytes;
}

std::vector<double> numbers_of(const StoredValues& stored, const std::string& name) {
  std::vector<double> values(stored.bytes / H5Tget_size(stored.type));
  require(H5Dread(stored.id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "read dataset " + name);
  return values;
}

// Copies of objects by plain reads and writes. The library's own H5Ocopy crashes in its clean-up where a read fails in
// the midst of it, as of a damaged block.

constexpr int kDeepest = 8;  // groups below one another, more than results have
/// Held in memory while a dataset is copied.
constexpr std::size_t kMostBytesCopied = std::size_t{8} << 20;

void copy_attribute(hid_t source, const std::string& name, hid_t target) {
  const std::string action = "copy attribute " + name;
  const StoredValues from = open_attribute(source, name, Stored::anything);
  std::vector<char> bytes(from.bytes);
  require(H5Aread(from.id, from.type, bytes.data()), action);
  const Handle to(H5Acreate2(target, name.c_str(), from.type, from.space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, action);
  require(H5Awrite(to, from.type, bytes.data()), action);
}

void copy_attributes(hid_t source, hid_t target) {
  for (const std::string& name : attribute_names(source)) copy_attribute(source, name, target);
}

/// Copies the numbers of a dataset, as many rows at a time as fit.
class RowCopy {
 public:
  RowCopy(const std::string& action, const StoredValues& from, hid_t to)
      : action_(action), from_(from.id), to_(to), type_(from.type), space_(from.space), shape_(from.shape) {}

  void all() {
    hsize_t numbers_in_row = 1;
    for (std::size_t i = 1; i < shape_.size(); ++i) numbers_in_row *= shape_[i];
    const hsize_t row_bytes = std::max<hsize_t>(1, numbers_in_row * H5Tget_size(type_));
    if (shape_.empty()) {
      std::vector<char> bytes(row_bytes);
      return move(H5S_ALL, H5S_ALL, bytes);
    }
    if (numbers_in_row == 0) return;
    const hsize_t most = std::max<hsize_t>(1, kMostBytesCopied / row_bytes);
    std::vector<char> bytes(std::min(most, shape_[0]) * row_bytes);
    for (hsize_t first = 0; first < shape_[0]; first += most) rows(first, std::min(most, shape_[0] - first), bytes);
  }

 private:
  void rows(hsize_t first, hsize_t count, std::vector<char>& bytes) {
    std::vector<hsize_t> start(shape_.size(), 0), part = shape_;
    start[0] = first;
    part[0] = count;
    const Handle memory(H5Screate_simple(static_cast<int>(part.size()), part.data(), nullptr), H5Sclose, action_);
    require(H5Sselect_hyperslab(space_, H5S_SELECT_SET, start.data(), nullptr, part.data(), nullptr), action_);
    move(memory, space_, bytes);
  }
  void move(hid_t memory, hid_t place, std::vector<char>& bytes) {
    require(H5Dread(from_, type_, memory, place, H5P_DEFAULT, bytes.data()), action_);
    require(H5Dwrite(to_, type_, memory, place, H5P_DEFAULT, bytes.data()), action_);
  }

  const std::string& action_;
  hid_t from_, to_, type_, space_;
  std::vector<hsize_t> shape_;
};

void copy_dataset(Handle dataset, const std::string& name, hid_t target) {
  const std::string action = "copy " + name;
  const StoredValues from = values_of(std::move(dataset), name, Stored::anything);
  const Handle creation(H5Dget_create_plist(from.id), H5Pclose, action);
  const Handle to(H5Dcreate2(target, name.c_str(), from.type, from.space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
                  action);
  RowCopy(action, from, to).all();
  copy_attributes(from.id, to);
}

/// `depth`: of groups that may follow; a group that holds itself has no end.
void copy_object(Handle from, const std::string& name, hid_t target, int depth) {
  if (depth < 0) throw Error("cannot copy " + name + ": it lies deeper than results do");
  if (!is_group(from)) return copy_dataset(std::move(from), name, target);
  const Handle to = create_group(target, name);
  copy_attributes(from, to);
  for (const ObjectLink& child : links_of(from)) copy_object(open_object(from, child.name), child.name, to, depth - 1);
}

}  // namespace

void require(herr_t status, const std::string& action) {
  if (status < 0) fail(action);
}

// Every use of the library begins here. Files are closed one by one, with checks; where one cannot be closed, for it is
// damaged, the library would try for ever when the program ends.
QuietScope::QuietScope() {
  [[maybe_unused]] static const herr_t no_cleaning_at_exit = H5dont_atexit();
  H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

QuietScope::~QuietScope() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

Handle::Handle(hid_t id, CloseFunction close_function, const std::string& action)
    : id_(id), close_function_(close_function) {
  if (id_ < 0) fail(action);
}

Handle::~Handle() { close(); }

void Handle::close() noexcept {
  if (id_ >= 0 && close_function_(std::exchange(id_, -1)) < 0) a_close_failed = true;
}

Handle create_group(hid_t parent, const std::string& name) {
  return {H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "create group " + name};
}

Handle open_group(hid_t parent, const std::string& name) {
  const std::string action = "open group " + name;
  require_hard_link(parent, name, action);
  return {H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, action};
}

StoredValues open_attribute(hid_t object, const std::string& name, Stored declared) {
  const std::string action = "read attribute " + name;
  Handle id(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, action);
  Handle type(H5Aget_type(id), H5Tclose, action), space(H5Aget_space(id), H5Sclose, action);
  StoredValues values{std::move(id), std::move(type), std::move(space)};
  measure(values, declared, action);
  if (!values.shape.empty()) refuse(action, "it is not one value");
  return values;
}

StoredValues values_of(Handle dataset, const std::string& name, Stored declared) {
  const std::string action = "read dataset " + name;
  require_plain_storage(dataset, action);
  Handle type(H5Dget_type(dataset), H5Tclose, action), space(H5Dget_space(dataset), H5Sclose, action);
  StoredValues values{std::move(dataset), std::move(type), std::move(space)};
  measure(values, declared, action);
  if (values.bytes > H5Dget_storage_size(values.id)) refuse(action, "a part of it is not in the file");
  return values;
}

StoredValues open_dataset(hid_t group, const std::string& name, Stored declared) {
  const std::string action = "read dataset " + name;
  require_hard_link(group, name, action);
  return values_of({H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, action}, name, declared);
}

void write_attribute(hid_t object, const std::string& name, double value) {
  write_scalar_attribute(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

void write_attribute(hid_t object, const std::string& name, int value) {
  write_scalar_attribute(object, name, H5T_STD_I32LE, H5T_NATIVE_INT, &value);
}

void write_attribute(hid_t object, const std::string& name, bool value) {
  write_attribute(object, name, value ? 1 : 0);
}

void write_attribute(hid_t object, const std::string& name, const std::string& value) {
  const Handle type = text_type(value);
  write_scalar_attribute(object, name, type, type, value.c_str());
}

void write_text(hid_t group, const std::string& name, const std::string& text) {
  const std::string action = "write text " + name;
  const Handle type = text_type(text);
  const Handle space = scalar_space();
  const Handle dataset(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, dataset_creation(), H5P_DEFAULT),
                       H5Dclose, action);
  require(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()), action);
}

void write_dataset(hid_t group, const std::string& name, const std::vector<double>& values, std::size_t columns) {
  std::vector<hsize_t> shape{values.size() / columns};
  if (columns > 1) shape.push_back(columns);
  write_array(group, name, shape, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data());
}

void write_dataset(hid_t group, const std::string& name, const std::vector<int>& values) {
  write_array(group, name, {values.size()}, H5T_STD_I32LE, H5T_NATIVE_INT, values.data());
}

void write_texts(hid_t group, const std::string& name, const std::vector<std::string>& texts) {
  std::size_t width = 1;
  for (const std::string& text : texts) width = std::max(width, text.size());
  const Handle type = text_type(std::string(width, ' '));
  std::string rows(width * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(&rows[width * i], texts[i].size());
  write_array(group, name, {texts.size()}, type, type, rows.data());
}

std::uint64_t place_dataset(hid_t parent, const std::string& name, bool integers, std::size_t rows,
                            std::size_t columns) {
  const std::string action = "create dataset " + name;
  std::vector<hsize_t> shape{rows};
  if (columns > 1) shape.push_back(columns);
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, action);
  const Handle creation = dataset_creation();
  require(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY), action);
  require(H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER), action);
  const Handle dataset(H5Dcreate2(parent, name.c_str(), integers ? H5T_STD_I32LE : H5T_IEEE_F64LE, space, H5P_DEFAULT,
                                  creation, H5P_DEFAULT),
                       H5Dclose, action);
  if (rows == 0) return 0;
  const haddr_t offset = H5Dget_offset(dataset);
  if (offset == HADDR_UNDEF) fail(action);
  return offset;
}

void append_rows(hid_t group, const std::string& name, const std::vector<double>& rows, std::size_t columns) {
  const std::string action = "append to time series " + name;
  const bool exists = has_link(group, name);
  std::vector<hsize_t> shape{0};
  if (columns > 1) shape.push_back(columns);
  const Handle dataset = exists ? Handle(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, action)
                                : create_extendible(group, name, shape);
  {
    const Handle space(H5Dget_space(dataset), H5Sclose, action);
    shape.resize(std::max(1, H5Sget_simple_extent_ndims(space)));  // a table of one column has two
    require(H5Sget_simple_extent_dims(space, shape.data(), nullptr), action);
  }
  std::vector<hsize_t> start(shape.size(), 0);
  start[0] = shape[0];
  std::vector<hsize_t> count = shape;
  count[0] = rows.size() / columns;
  if (count[0] == 0) return;
  shape[0] += count[0];
  require(H5Dset_extent(dataset, shape.data()), action);
  const Handle target(H5Dget_space(dataset), H5Sclose, action);
  require(H5Sselect_hyperslab(target, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr), action);
  const Handle source(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose, action);
  require(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, source, target, H5P_DEFAULT, rows.data()), action);
}

void append_row(hid_t group, const std::string& name, std::vector<double> row) {
  const std::string action = "append to table " + name;
  std::array<hsize_t, 2> shape{0, 0}, limits{H5S_UNLIMITED, H5S_UNLIMITED}, chunk{kTableChunk, kTableChunk};
  if (!has_link(group, name)) {
    const Handle creation = dataset_creation(),
                 space(H5Screate_simple(2, shape.data(), limits.data()), H5Sclose, action);
    require(H5Pset_chunk(creation, 2, chunk.data()), action);
    require(H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, &kMissing), action);
    require(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY), action);
    const Handle made(H5Dcreate2(group, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT),
                      H5Dclose, action);
  }
  {
    const Handle dataset(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, action);
    const Handle space(H5Dget_space(dataset), H5Sclose, action);
    require(H5Sget_simple_extent_dims(space, shape.data(), nullptr), action);
    shape[1] = std::max<hsize_t>(shape[1], row.size());
    require(H5Dset_extent(dataset, shape.data()), action);
  }
  row.resize(shape[1], kMissing);
  append_rows(group, name, row, shape[1]);
}

void remove_link(hid_t parent, const std::string& name) {
  require(H5Ldelete(parent, name.c_str(), H5P_DEFAULT), "remove " + name);
}

bool has_link(hid_t group, const std::string& name) {
  const htri_t exists = H5Lexists(group, name.c_str(), H5P_DEFAULT);
  if (exists < 0) fail("look for " + name);
  return exists > 0;
}

std::size_t count_links(hid_t group) {
  H5G_info_t info;
  require(H5Gget_info(group, &info), "count the entries of a group");
  return info.nlinks;
}

std::vector<ObjectLink> links_of(hid_t group) {
  std::vector<ObjectLink> links;
  const auto keep = [](hid_t, const char* name, const H5L_info_t* link, void* found) -> herr_t {
    static_cast<std::vector<ObjectLink>*>(found)->push_back({name, link->type == H5L_TYPE_HARD ? link->u.address : 0});
    return link->type == H5L_TYPE_HARD ? 0 : 1;
  };
  const herr_t end = H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep, &links);
  require(end, "read the names in a group");
  if (end > 0) refuse("open " + links.back().name, kLeavesFile);
  for (const ObjectLink& link : links) require_plain_name(link.name, "open " + link.name);
  return links;
}

std::vector<std::string> link_names(hid_t group) {
  std::vector<std::string> names;
  for (ObjectLink& link : links_of(group)) names.push_back(std::move(link.name));
  return names;
}

std::vector<std::string> attribute_names(hid_t object) {
  const auto keep = [](hid_t, const char* name, const H5A_info_t*, void* names) -> herr_t {
    static_cast<std::vector<std::string>*>(names)->push_back(name);
    return 0;
  };
  std::vector<std::string> names;
  require(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep, &names), "read the names of attributes");
  return names;
}

double read_number(hid_t object, const std::string& attribute) {
  const StoredValues stored = open_attribute(object, attribute, Stored::numbers);
  double value = 0.0;
  require(H5Aread(stored.id, H5T_NATIVE_DOUBLE, &value), "read attribute " + attribute);
  return value;
}

std::string read_text_attribute(hid_t object, const std::string& attribute) {
  const StoredValues stored = open_attribute(object, attribute, Stored::texts);
  std::string text(stored.bytes, '\0');
  require(H5Aread(stored.id, stored.type, text.data()), "read attribute " + attribute);
  return text.c_str();  // an empty text is stored as one zero
}

void read_attribute(hid_t object, const std::string& name, double& value) {
  value = read_number(object, name);
  if (!std::isfinite(value)) refuse("read attribute " + name, "it is not a finite number");
}

void read_attribute(hid_t object, const std::string& name, int& value) {
  constexpr int kMost = 1'000'000'000;  // counts; adding one must not overflow
  const StoredValues stored = open_attribute(object, name, Stored::integers);
  require(H5Aread(stored.id, H5T_NATIVE_INT, &value), "read attribute " + name);
  if (value < -kMost || value > kMost) refuse("read attribute " + name, "its value is beyond all counts");
}

void read_attribute(hid_t object, const std::string& name, bool& value) {
  int number = 0;
  read_attribute(object, name, number);
  value = number != 0;
}

void read_attribute(hid_t object, const std::string& name, std::string& value) {
  value = read_text_attribute(object, name);
}

bool has_attribute(hid_t object, const std::string& name) {
  const htri_t exists = H5Aexists(object, name.c_str());
  if (exists < 0) fail("look for attribute " + name);
  return exists > 0;
}

std::string read_text(hid_t group, const std::string& name) {
  const std::string action = "read text " + name;
  const StoredValues stored = open_dataset(group, name, Stored::texts);
  if (!stored.shape.empty()) refuse(action, "it is not one text");
  std::string text = bytes_of(stored, action);
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::vector<std::string> read_texts(hid_t group, const std::string& name) {
  const std::string action = "read texts " + name;
  const StoredValues stored = open_dataset(group, name, Stored::texts);
  if (stored.shape.size() != 1) refuse(action, "they are not a list");
  const std::string rows = bytes_of(stored, action);
  const std::size_t width = H5Tget_size(stored.type);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < rows.size(); i += width) {
    texts.push_back(rows.substr(i, width));
    texts.back().resize(std::min(width, texts.back().find('\0')));
  }
  return texts;
}

void read_attributes(hid_t object) {
  for (const std::string& name : attribute_names(object)) {
    const StoredValues stored = open_attribute(object, name, Stored::anything);
    std::vector<char> bytes(stored.bytes);
    require(H5Aread(stored.id, stored.type, bytes.data()), "read attribute " + name);
  }
}

Handle open_object(hid_t parent, const std::string& name) {
  return {H5Oopen(parent, name.c_str(), H5P_DEFAULT), H5Oclose, "open " + name};
}

void read_all(const StoredValues& dataset, const std::string& name) { bytes_of(dataset, "read dataset " + name); }

bool is_group(hid_t object) { return H5Iget_type(object) == H5I_GROUP; }

std::pair<std::uint64_t, std::uint64_t> data_place(const StoredValues& dataset) {
  const haddr_t offset = H5Dget_offset(dataset.id);
  if (offset == HADDR_UNDEF) return {0, 0};
  return {offset, dataset.bytes};
}

std::vector<double> read_dataset(hid_t group, const std::string& name, std::size_t columns, Stored declared) {
  const StoredValues stored = open_dataset(group, name, declared);
  const bool is_column = stored.shape.size() == 1 && columns == 1;
  if (!is_column && (stored.shape.size() != 2 || stored.shape[1] != columns))
    refuse("read dataset " + name, "its shape is not the one that it has in results");
  return numbers_of(stored, name);
}

std::vector<double> read_series(hid_t group, const std::string& name, std::size_t& columns) {
  const StoredValues stored = open_dataset(group, name, Stored::reals);
  if (stored.shape.empty()) refuse("read dataset " + name, "it is not a table");
  columns = stored.shape.size() > 1 ? static_cast<std::size_t>(stored.shape[1]) : 1;
  if (columns == 0) refuse("read dataset " + name, "its rows are empty");
  return numbers_of(stored, name);
}

void copy_link(hid_t source, const std::string& name, hid_t target) {
  copy_object(open_object(source, name), name, target, kDeepest);
}

}  // namespace mixbeam::hdf5
