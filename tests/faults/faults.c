/* Faults in turn: loaded into a program by LD_PRELOAD, this library counts the calls that reach its files, lets the n-th of
 * them fail or kills the program there, or records everything that is written. faults.py is its driver.
 *
 *   FAULTS_FOLDER   files below this folder are watched, and those with a relative name (the program starts there)
 *   FAULTS_LOG      gets, at the end, how many calls of each class there were; while recording, every call; and what failed
 *   FAULTS_PROGRAM  name of the program; others (mpirun, a shell) are left alone, and so is what the program starts itself
 *   FAULTS_RANK     of the rank of mpirun that is disturbed (all: not set)
 *   FAULTS_CLASS    write, open, sync, rename, truncate, close, read, alloc, or any: all that change files
 *   FAULTS_AT       which call, from 1
 *   FAULTS_KIND     full (ENOSPC, from that call on), error (EIO), interrupt (EINTR), short (half of it is done), kill
 *   FAULTS_RECORD   1: record
 */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <link.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/auxv.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

enum Class { kWrite, kOpen, kSync, kRename, kTruncate, kClose, kUnlink, kRead, kAlloc, kClasses, kAny };
static const char* const kNames[] = {"write", "open", "sync", "rename", "truncate", "close", "unlink", "read", "alloc"};
enum Kind { kNone, kFull, kError, kInterrupt, kShort, kKill };
static const char* const kKinds[] = {"", "full", "error", "interrupt", "short", "kill"};
enum { kSmallAllocation = 1024 }; /* bytes; programs cannot be expected to survive without the smallest */

static int active, recording, log_file = -1;
static int wanted_class = -1, kind;
static long at, count[kClasses], count_any;
static char folder[PATH_MAX];
static size_t folder_length;
static const void *program_base, *kokkos_base, *cxx_base;
enum Inside { kOutside, kCounted, kFails };
static __thread enum Inside inside_new; /* operator new, which has counted the allocation */

void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);

#define REAL(type, name, ...)                       \
  static type (*real)(__VA_ARGS__);                 \
  if (!real) *(void**)&real = dlsym(RTLD_NEXT, name)

static void say(const char* text, size_t size) {
  while (size > 0) {
    const ssize_t done = syscall(SYS_write, log_file, text, size);
    if (done <= 0) return;
    text += done;
    size -= (size_t)done;
  }
}

static int find(const char* word, const char* const* words, int number) {
  for (int i = 0; word && i < number; ++i)
    if (strcmp(word, words[i]) == 0) return i;
  return -1;
}

static int note_base(struct dl_phdr_info* info, size_t size, void* unused) {
  (void)size, (void)unused;
  if (strstr(info->dlpi_name, "kokkoscore")) kokkos_base = (const void*)info->dlpi_addr;
  if (strstr(info->dlpi_name, "libstdc++")) cxx_base = (const void*)info->dlpi_addr;
  return 0;
}

__attribute__((constructor)) static void begin(void) {
  const char* program = getenv("FAULTS_PROGRAM");
  const char* wanted_rank = getenv("FAULTS_RANK");
  const char* rank = getenv("OMPI_COMM_WORLD_RANK");
  if (!program || !getenv("FAULTS_FOLDER") || strcmp(program, program_invocation_short_name) != 0) return;
  if (wanted_rank && (!rank || strcmp(rank, wanted_rank) != 0)) return;
  snprintf(folder, sizeof folder, "%s/", getenv("FAULTS_FOLDER"));
  folder_length = strlen(folder);
  log_file = (int)syscall(SYS_openat, AT_FDCWD, getenv("FAULTS_LOG"), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  recording = getenv("FAULTS_RECORD") != NULL;
  const char* class_name = getenv("FAULTS_CLASS");
  wanted_class = class_name && strcmp(class_name, "any") == 0 ? kAny : find(class_name, kNames, kClasses);
  kind = getenv("FAULTS_KIND") ? find(getenv("FAULTS_KIND"), kKinds, 6) : kNone;
  at = getenv("FAULTS_AT") ? atol(getenv("FAULTS_AT")) : 0;
  Dl_info info;
  if (dladdr((const void*)getauxval(AT_ENTRY), &info)) program_base = info.dli_fbase;
  dl_iterate_phdr(note_base, NULL);
  unsetenv("FAULTS_PROGRAM"); /* for what the program starts */
  active = 1;
}

__attribute__((destructor)) static void end(void) {
  if (!active || log_file < 0 || recording) return;
  for (int i = 0; i < kClasses; ++i) {
    char line[64];
    say(line, (size_t)snprintf(line, sizeof line, "count %s %ld\n", kNames[i], count[i]));
  }
  char line[64];
  say(line, (size_t)snprintf(line, sizeof line, "count any %ld\n", count_any));
}

/* True where this call of a class is to fail (errno is then set) or to be cut short; does not return where it kills. */
static int hit(enum Class of, const char* path) {
  const int errno_before = errno;
  const long here = __atomic_add_fetch(&count[of], 1, __ATOMIC_RELAXED);
  const long any = of < kRead ? __atomic_add_fetch(&count_any, 1, __ATOMIC_RELAXED) : -1;
  const long number = wanted_class == kAny ? any : here;
  const int of_class = wanted_class == kAny ? of < kRead : wanted_class == (int)of;
  /* A full disk refuses new data and new names; it lets go of old ones. */
  const int full = kind == kFull && wanted_class < kAlloc && count[wanted_class] >= at &&
                   (of == kWrite || of == kOpen || (int)of == wanted_class);
  if (kind == kNone || at == 0 || !((of_class && number == at) || full)) return errno = errno_before, 0;
  char line[PATH_MAX + 64];
  say(line, (size_t)snprintf(line, sizeof line, "hit %s %s\n", kNames[of], path ? path : ""));
  if (kind == kKill) {
    syscall(SYS_kill, getpid(), 9);
    for (;;) pause();
  }
  if (of == kAlloc) errno = ENOMEM;
  else errno = kind == kFull ? ENOSPC : kind == kInterrupt ? EINTR : EIO;
  return 1;
}

static const char* watched_name(const char* path) {
  if (!active || !path) return NULL;
  return path[0] != '/' || strncmp(path, folder, folder_length) == 0 ? path : NULL;
}

/* Name of an open file that is watched, else a null pointer. */
static const char* watched_file(int file, char* name) {
  if (!active || file == log_file) return NULL;
  const int errno_before = errno;
  char link[64];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link, name, PATH_MAX - 1);
  errno = errno_before;
  if (length < (ssize_t)folder_length - 1) return NULL;
  name[length] = 0;
  if (length == (ssize_t)folder_length - 1) return strncmp(name, folder, (size_t)length) == 0 ? name : NULL;
  return strncmp(name, folder, folder_length) == 0 ? name : NULL;
}

/* Recorded calls: a line each, in the order in which they succeeded; `write` is followed by its bytes. */
static void record(const char* call, int file, long long place, size_t size, const char* path, const char* other) {
  if (!recording) return;
  const int errno_before = errno;
  char line[2 * PATH_MAX + 96];
  say(line, (size_t)snprintf(line, sizeof line, "%s\t%d\t%d\t%lld\t%zu\t%s\t%s\n", call, (int)getpid(), file, place, size,
                             path ? path : "", other ? other : ""));
  errno = errno_before;
}

static void record_write(int file, long long place, const struct iovec* parts, int number, ssize_t size) {
  if (!recording || size <= 0) return;
  record("write", file, place, (size_t)size, NULL, NULL);
  size_t left = (size_t)size;
  for (int i = 0; i < number && left > 0; ++i) {
    const size_t part = parts[i].iov_len < left ? parts[i].iov_len : left;
    say(parts[i].iov_base, part);
    left -= part;
  }
}

static ssize_t write_at(int file, const struct iovec* parts, int number, off_t place) {
  char name[PATH_MAX];
  struct iovec half;
  const char* watched = watched_file(file, name);
  if (watched && hit(kWrite, watched)) {
    if (kind != kShort) return -1;
    half = parts[0];
    half.iov_len = half.iov_len > 1 ? half.iov_len / 2 : half.iov_len;
    parts = &half;
    number = 1;
  }
  const off_t here = watched && recording && place < 0 ? (off_t)syscall(SYS_lseek, file, 0, SEEK_CUR) : place;
  const ssize_t done = place < 0 ? syscall(SYS_writev, file, parts, number)
                                 : syscall(SYS_pwritev, file, parts, number, (long)place, 0L);
  if (watched) record_write(file, here, parts, number, done);
  return done;
}

ssize_t write(int file, const void* data, size_t size) {
  const struct iovec part = {(void*)data, size};
  return active ? write_at(file, &part, 1, -1) : syscall(SYS_write, file, data, size);
}
ssize_t pwrite(int file, const void* data, size_t size, off_t place) {
  const struct iovec part = {(void*)data, size};
  return write_at(file, &part, 1, place);
}
ssize_t pwrite64(int file, const void* data, size_t size, off64_t place) { return pwrite(file, data, size, place); }
ssize_t writev(int file, const struct iovec* parts, int number) { return write_at(file, parts, number, -1); }
ssize_t pwritev(int file, const struct iovec* parts, int number, off_t place) {
  return write_at(file, parts, number, place);
}

/* As the C++ library copies files: piece by piece through the calls above. */
ssize_t sendfile(int out, int in, off_t* place, size_t size) {
  char piece[65536];
  const size_t wanted = size < sizeof piece ? size : sizeof piece;
  const ssize_t got = place ? pread(in, piece, wanted, *place) : read(in, piece, wanted);
  if (got <= 0) return got;
  const ssize_t done = write(out, piece, (size_t)got);
  if (done > 0 && place) *place += done;
  return done;
}
ssize_t sendfile64(int out, int in, off64_t* place, size_t size) { return sendfile(out, in, place, size); }

static int read_fails(int file) {
  char name[PATH_MAX];
  const char* watched = watched_file(file, name);
  return watched && hit(kRead, watched);
}
ssize_t read(int file, void* data, size_t size) {
  if (active && read_fails(file)) {
    if (kind != kShort) return -1;
    size = size > 1 ? size / 2 : size;
  }
  return syscall(SYS_read, file, data, size);
}
ssize_t pread(int file, void* data, size_t size, off_t place) {
  if (active && read_fails(file)) {
    if (kind != kShort) return -1;
    size = size > 1 ? size / 2 : size;
  }
  return syscall(SYS_pread64, file, data, size, place);
}
ssize_t pread64(int file, void* data, size_t size, off64_t place) { return pread(file, data, size, place); }

static int opened(int folder_file, const char* path, int flags, mode_t mode) {
  const char* watched = watched_name(path);
  if (watched && hit(kOpen, watched) && kind != kShort) return -1;
  const int file = (int)syscall(SYS_openat, folder_file, path, flags, mode);
  if (watched && file >= 0) record(flags & O_TRUNC ? "create" : "open", file, flags, 0, path, NULL);
  return file;
}
static mode_t mode_of(int flags, va_list rest) { return flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0; }
// The parameters before the path come last, with their comma.
#define OPENS(name, folder, ...)                            \
  int name(__VA_ARGS__ const char* path, int flags, ...) { \
    va_list rest;                                           \
    va_start(rest, flags);                                  \
    const mode_t mode = mode_of(flags, rest);               \
    va_end(rest);                                           \
    return opened(folder, path, flags, mode);               \
  }
OPENS(open, AT_FDCWD, )
OPENS(open64, AT_FDCWD, )
OPENS(openat, folder_file, int folder_file, )
OPENS(openat64, folder_file, int folder_file, )
int creat(const char* path, mode_t mode) { return opened(AT_FDCWD, path, O_CREAT | O_WRONLY | O_TRUNC, mode); }
int creat64(const char* path, mode_t mode) { return creat(path, mode); }

static FILE* stream_opened(const char* path, const char* mode, FILE* (*real)(const char*, const char*)) {
  const char* watched = watched_name(path);
  if (watched && hit(kOpen, watched) && kind != kShort) return NULL;
  FILE* file = real(path, mode);
  if (watched && file) record(mode[0] == 'w' ? "create" : "open", fileno(file), mode[0] == 'r' ? 0 : O_CREAT, 0, path, NULL);
  return file;
}
FILE* fopen(const char* path, const char* mode) {
  REAL(FILE*, "fopen", const char*, const char*);
  return stream_opened(path, mode, real);
}
FILE* fopen64(const char* path, const char* mode) {
  REAL(FILE*, "fopen64", const char*, const char*);
  return stream_opened(path, mode, real);
}

int mkdir(const char* path, mode_t mode) {
  const char* watched = watched_name(path);
  if (watched && hit(kOpen, watched) && kind != kShort) return -1;
  const int status = (int)syscall(SYS_mkdir, path, mode);
  if (watched && status == 0) record("mkdir", -1, 0, 0, path, NULL);
  return status;
}

/* The file is closed whatever is told, as Linux does it. */
static int close_fails(int file) {
  char name[PATH_MAX];
  const char* watched = watched_file(file, name);
  if (!watched) return 0;
  const int fails = hit(kClose, watched) && kind != kShort;
  record("close", file, 0, 0, NULL, NULL);
  return fails;
}
int close(int file) {
  if (file == log_file && active) return 0;
  const int fails = close_fails(file), reason = errno;
  const int status = (int)syscall(SYS_close, file);
  return fails ? (errno = reason, -1) : status;
}
int fclose(FILE* file) {
  REAL(int, "fclose", FILE*);
  const int fails = file ? close_fails(fileno(file)) : 0, reason = errno;
  const int status = real(file);
  return fails ? (errno = reason, EOF) : status;
}

static int synced(int file, long call) {
  char name[PATH_MAX];
  const char* watched = watched_file(file, name);
  if (watched && hit(kSync, watched) && kind != kShort) return -1;
  const int status = (int)syscall(call, file);
  if (watched && status == 0) record("sync", file, 0, 0, watched, NULL);
  return status;
}
int fsync(int file) { return synced(file, SYS_fsync); }
int fdatasync(int file) { return synced(file, SYS_fdatasync); }

int ftruncate(int file, off_t size) {
  char name[PATH_MAX];
  const char* watched = watched_file(file, name);
  if (watched && hit(kTruncate, watched) && kind != kShort) return -1;
  const int status = (int)syscall(SYS_ftruncate, file, size);
  if (watched && status == 0) record("truncate", file, size, 0, NULL, NULL);
  return status;
}
int ftruncate64(int file, off64_t size) { return ftruncate(file, size); }

int posix_fallocate(int file, off_t place, off_t size) {
  char name[PATH_MAX];
  const char* watched = watched_file(file, name);
  if (watched && hit(kTruncate, watched) && kind != kShort) return errno;
  if (syscall(SYS_fallocate, file, 0, place, size) != 0) return errno;
  if (watched) record("extend", file, place + size, 0, NULL, NULL);
  return 0;
}
int posix_fallocate64(int file, off64_t place, off64_t size) { return posix_fallocate(file, place, size); }

static int moved(const char* call, long number, const char* from, const char* to) {
  const char* watched = watched_name(to);
  if (watched && hit(kRename, watched) && kind != kShort) return -1;
  const int status = (int)syscall(number, from, to);
  if (watched && status == 0) record(call, -1, 0, 0, from, to);
  return status;
}
int rename(const char* from, const char* to) { return moved("rename", SYS_rename, from, to); }
int link(const char* from, const char* to) { return moved("link", SYS_link, from, to); }

static int removed(const char* path, int in_folder, int flags) {
  const char* watched = watched_name(path);
  if (watched && hit(kUnlink, watched) && kind != kShort) return -1;
  const int status = (int)syscall(SYS_unlinkat, in_folder, path, flags);
  if (watched && status == 0) record("unlink", -1, 0, 0, path, NULL);
  return status;
}
int unlink(const char* path) { return removed(path, AT_FDCWD, 0); }
int unlinkat(int in_folder, const char* path, int flags) { return removed(path, in_folder, flags); }
int remove(const char* path) {
  const int status = removed(path, AT_FDCWD, 0);
  return status != 0 && errno == EISDIR ? (int)syscall(SYS_rmdir, path) : status;
}

/* Allocations above kSmallAllocation, made by the program's own code, by the C++ library for it, or by Kokkos. Code of the
 * program asks operator new; malloc is asked by the C libraries that are linked into it, as HDF5, and how they go on without
 * memory is theirs (HDF5 1.10 damages its heap at some places, or crashes). */
static int allocation_fails(size_t size, const void* caller, int is_new) {
  if (!active || size <= kSmallAllocation || inside_new == kCounted) return 0;
  if (inside_new == kFails) return inside_new = kOutside, errno = ENOMEM, 1;
  Dl_info info;
  if (!dladdr(caller, &info)) return 0;
  const int is_own = is_new && info.dli_fbase == program_base;
  if (!is_own && info.dli_fbase != kokkos_base && info.dli_fbase != cxx_base) return 0;
  return hit(kAlloc, info.dli_sname);
}
#define CALLER __builtin_return_address(0)
void* malloc(size_t size) { return allocation_fails(size, CALLER, 0) ? NULL : __libc_malloc(size); }
void* calloc(size_t number, size_t size) {
  return allocation_fails(number * size, CALLER, 0) ? NULL : __libc_calloc(number, size);
}
void* realloc(void* old, size_t size) { return allocation_fails(size, CALLER, 0) ? NULL : __libc_realloc(old, size); }
void* memalign(size_t alignment, size_t size) {
  return allocation_fails(size, CALLER, 0) ? NULL : __libc_memalign(alignment, size);
}
void* aligned_alloc(size_t alignment, size_t size) {
  return allocation_fails(size, CALLER, 0) ? NULL : __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, size_t alignment, size_t size) {
  if (allocation_fails(size, CALLER, 0)) return ENOMEM;
  void* block = __libc_memalign(alignment, size);
  if (!block) return ENOMEM;
  *memory = block;
  return 0;
}

/* Operator new: only here it is known who called. Its own malloc is no second call; that it is to fail is told to that
 * malloc, so that operator new throws as it would without memory. */
static void* allocated(void* (*real)(size_t), size_t size, const void* caller) {
  inside_new = allocation_fails(size, caller, 1) ? kFails : kCounted;
  void* block = real(size);
  inside_new = kOutside;
  return block;
}
void* _Znwm(size_t size) {
  REAL(void*, "_Znwm", size_t);
  return allocated(real, size, CALLER);
}
void* _Znam(size_t size) {
  REAL(void*, "_Znwm", size_t);
  return allocated(real, size, CALLER);
}
void* _ZnwmSt11align_val_t(size_t size, size_t alignment) {
  REAL(void*, "_ZnwmSt11align_val_t", size_t, size_t);
  inside_new = allocation_fails(size, CALLER, 1) ? kFails : kCounted;
  void* block = real(size, alignment);
  inside_new = kOutside;
  return block;
}
void* _ZnwmRKSt9nothrow_t(size_t size, const void* tag) {
  (void)tag;
  return allocation_fails(size, CALLER, 1) ? NULL : __libc_malloc(size ? size : 1);
}
