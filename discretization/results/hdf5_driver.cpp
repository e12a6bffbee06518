#include "discretization/results/hdf5_writer.hpp"

#include "discretization/text/errors.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace mixbeam::hdf5 {

/// The calls by which the library reaches a file; none of them may throw.
struct Driver {
  H5FD_t common;  ///< the library's own, first
  File::Medium* medium;
  haddr_t end;  ///< of the allocated space

  static Driver& of(H5FD_t* file) { return *reinterpret_cast<Driver*>(file); }
  static const Driver& of(const H5FD_t* file) { return *reinterpret_cast<const Driver*>(file); }

  static H5FD_t* open(const char*, unsigned flags, hid_t access, haddr_t) {
    const void* const info = H5Pget_driver_info(access);
    if (info == nullptr) return nullptr;
    auto* const driver = static_cast<Driver*>(std::calloc(1, sizeof(Driver)));
    if (driver == nullptr) return nullptr;
    driver->medium = *static_cast<File::Medium* const*>(info);
    if ((flags & H5F_ACC_TRUNC) != 0) driver->remember([&] { driver->medium->content->resize(0); });
    return &driver->common;
  }
  static herr_t close(H5FD_t* file) {
    std::free(&of(file));
    return 0;
  }
  /// Returns the flags of the library's own driver, so that files are laid out in the same way.
  static herr_t query(const H5FD_t*, unsigned long* flags) {
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
    return 0;
  }
  static haddr_t get_eoa(const H5FD_t* file, H5FD_mem_t) { return of(file).end; }
  static herr_t set_eoa(H5FD_t* file, H5FD_mem_t, haddr_t address) {
    of(file).end = address;
    return 0;
  }
  static haddr_t get_eof(const H5FD_t* file, H5FD_mem_t) { return of(file).medium->content->size(); }

  static herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, void* buffer) {
    GuardedFile& content = *of(file).medium->content;
    const std::size_t there = address < content.size() ? std::min<std::size_t>(size, content.size() - address) : 0;
    std::memset(static_cast<char*>(buffer) + there, 0, size - there);
    try {
      content.read(address, buffer, there);
      return 0;
    } catch (const std::exception& error) {
      H5Epush2(H5E_DEFAULT, __FILE__, __func__, __LINE__, H5E_ERR_CLS, H5E_IO, H5E_READERROR, "%s",
               reason_of(error).c_str());
      return -1;
    }
  }
  static herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, const void* buffer) {
    of(file).remember([&] { of(file).medium->content->write(address, buffer, size); });
    return 0;
  }
  static herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
    Driver& driver = of(file);
    if (driver.end != driver.medium->content->size())
      driver.remember([&] { driver.medium->content->resize(driver.end); });
    return 0;
  }

 private:
  template <class Action>
  void remember(const Action& action) {
    if (medium->problem) return;
    try {
      action();
    } catch (...) {
      medium->problem = std::current_exception();
    }
  }
};

namespace {

hid_t registered_driver() {
  static const hid_t number = [] {
    static H5FD_class_t calls{};
    calls.name = "mixbeam";
    calls.maxaddr = HADDR_MAX;
    calls.fc_degree = H5F_CLOSE_STRONG;
    calls.fapl_size = sizeof(void*);
    calls.open = Driver::open;
    calls.close = Driver::close;
    calls.query = Driver::query;
    calls.get_eoa = Driver::get_eoa;
    calls.set_eoa = Driver::set_eoa;
    calls.get_eof = Driver::get_eof;
    calls.read = Driver::read;
    calls.write = Driver::write;
    calls.truncate = Driver::truncate;
    const H5FD_mem_t lists[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(lists), std::end(lists), calls.fl_map);
    return H5FDregister(&calls);
  }();
  return number;
}

constexpr std::size_t kMostBytesOfStructure = std::size_t{1} << 20;

Handle opened(const void* medium, FileUse use) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make file access properties");
  if (H5Pset_driver(access, registered_driver(), &medium) < 0) throw Error("cannot choose the driver of the file");
  if (use == FileUse::read) {  // each object is visited once or twice, and the library keeps kilobytes of each
    H5AC_cache_config_t cache{};
    cache.version = H5AC__CURR_CACHE_CONFIG_VERSION;
    H5Pget_mdc_config(access, &cache);
    cache.set_initial_size = true;
    cache.max_size = cache.initial_size = cache.min_size = kMostBytesOfStructure;
    H5Pset_mdc_config(access, &cache);
  }
  const char* const unused = "results";
  if (use == FileUse::create)
    return {H5Fcreate(unused, H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose, "create the file"};
  return {H5Fopen(unused, use == FileUse::read ? H5F_ACC_RDONLY : H5F_ACC_RDWR, access), H5Fclose, "open the file"};
}

}  // namespace

File::File(GuardedFile& content, FileUse use) : medium_(new Medium{&content, {}}), handle_(opened(medium_.get(), use)) {
  a_close_failed = false;
}

void File::close() {
  handle_.close();
  if (medium_->problem) std::rethrow_exception(medium_->problem);
  if (a_close_failed) throw Error("cannot complete the file: the HDF5 library could not close an object");
}

}  // namespace mixbeam::hdf5
