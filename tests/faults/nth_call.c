/* Makes the n-th of a program's system calls go wrong. To be preloaded, with
 *
 *   NTH_CALL="write 7 5"       the 7th write fails with errno 5
 *   NTH_CALL="write 7 short"   it writes one byte; of read and write alone
 *   NTH_CALL="any 7 kill"      the program is killed at the 7th of all calls, before it happens
 *   NTH_CALL="any 7 cut"       the power is cut there: data and names that were not synced are lost
 *   NTH_CALL="any 7 torn"      the same, but renames are kept, and the files behind them are empty
 *   NTH_CALL="count"           nothing; NTH_CALL_LOG gets a line "NAME COUNT" for each call at the end
 *
 * Calls on files count where the path is relative, or the descriptor was opened by such a path: tests use relative
 * paths. Names: open read write fsync rename mkdir unlink flock mmap thread new. */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { OPEN, READ, WRITE, FSYNC, RENAME, MKDIR, UNLINK, FLOCK, MMAP, THREAD, NEW, KINDS };
static const char* const kNames[KINDS] = {"open",   "read",  "write", "fsync",  "rename", "mkdir",
                                          "unlink", "flock", "mmap",  "thread", "new"};
enum { kNone, kErrno, kShort, kKill, kCut, kTorn };

static int kind = -1, effect = kNone, number; /* kind KINDS: any of those on files */
static long wanted, counts[KINDS + 1];
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

/* --- what a power cut takes back --- */
enum { kMostFiles = 4096, kLongest = 400 };
struct open_file {
  int used;
  char path[kLongest];
  int writes; /* opened to write */
};
static struct open_file files[kMostFiles]; /* by descriptor */
enum change_kind { kMade, kMadeFolder, kRenamed, kRemoved };
struct change {
  enum change_kind kind;
  int lost; /* 0 once the folder was synced */
  char from[kLongest], to[kLongest], saved[kLongest];
};
static struct change changes[kMostFiles];
static int change_count;
struct written {
  char path[kLongest];
  off_t synced;
  int dirty;
};
static struct written writes[kMostFiles];
static int write_count, saved_count;

static int tracks(void) { return effect == kCut || effect == kTorn; }

static void folder_of(const char* path, char* folder) {
  snprintf(folder, kLongest, "%s", path);
  char* slash = strrchr(folder, '/');
  if (slash == NULL) snprintf(folder, kLongest, ".");
  if (slash != NULL) *slash = '\0';
}

static struct written* written_of(const char* path) {
  for (int i = write_count - 1; i >= 0; --i) {
    if (strcmp(writes[i].path, path) == 0) return &writes[i];
  }
  if (write_count == kMostFiles) abort();
  struct written* file = &writes[write_count++];
  snprintf(file->path, kLongest, "%s", path);
  file->synced = 0;
  file->dirty = 0;
  return file;
}

static struct change* new_change(enum change_kind what, const char* from, const char* to) {
  if (change_count == kMostFiles) abort();
  struct change* change = &changes[change_count++];
  memset(change, 0, sizeof *change);
  change->kind = what;
  change->lost = 1;
  snprintf(change->from, kLongest, "%s", from);
  snprintf(change->to, kLongest, "%s", to);
  return change;
}

/* Keeps what a rename or an unlink takes away, so that it can come back. */
static void save(struct change* change, const char* path) {
  char saved[kLongest];
  snprintf(saved, kLongest, ".nth-call-%d", saved_count++);
  if (syscall(SYS_linkat, AT_FDCWD, path, AT_FDCWD, saved, 0) == 0) snprintf(change->saved, kLongest, "%s", saved);
}

static void move_tree(const char* from, const char* to) {
  const size_t length = strlen(from);
  for (int i = 0; i < write_count; ++i) {
    if (strncmp(writes[i].path, from, length) != 0) continue;
    if (writes[i].path[length] != '\0' && writes[i].path[length] != '/') continue;
    char moved[kLongest];
    if (snprintf(moved, sizeof moved, "%s%s", to, writes[i].path + length) >= kLongest) abort();
    memcpy(writes[i].path, moved, sizeof moved);
  }
}

static void lose_data(void) {
  for (int i = 0; i < write_count; ++i) {
    if (writes[i].dirty) truncate(writes[i].path, writes[i].synced);
  }
}

static void undo(const struct change* change) {
  if (change->kind == kMade) syscall(SYS_unlink, change->from);
  if (change->kind == kMadeFolder) syscall(SYS_rmdir, change->from);
  if (change->kind == kRenamed) syscall(SYS_rename, change->to, change->from);
  const char* place = change->kind == kRenamed ? change->to : change->from;
  if (change->saved[0] != '\0') syscall(SYS_rename, change->saved, place);
}

static void cut_power(void) {
  lose_data();
  for (int i = change_count - 1; i >= 0; --i) {
    if (changes[i].lost && effect == kCut) undo(&changes[i]);
    if (changes[i].saved[0] != '\0') syscall(SYS_unlink, changes[i].saved);
  }
  _exit(137);
}

/* --- which call it is --- */
static void read_order(void) {
  static int done;
  if (done) return;
  done = 1;
  const char* order = getenv("NTH_CALL");
  char name[16] = "", what[16] = "";
  if (order == NULL || sscanf(order, "%15s %ld %15s", name, &wanted, what) < 1) return;
  for (int i = 0; i < KINDS; ++i) {
    if (strcmp(name, kNames[i]) == 0) kind = i;
  }
  if (strcmp(name, "any") == 0) kind = KINDS;
  number = atoi(what);
  effect = strcmp(what, "short") == 0  ? kShort
           : strcmp(what, "kill") == 0 ? kKill
           : strcmp(what, "cut") == 0  ? kCut
           : strcmp(what, "torn") == 0 ? kTorn
           : number > 0                ? kErrno
                                       : kNone;
}

__attribute__((constructor)) static void start(void) { read_order(); }

__attribute__((destructor)) static void tell_counts(void) {
  const char* log = getenv("NTH_CALL_LOG");
  FILE* file = log == NULL ? NULL : fopen(log, "w");
  if (file == NULL) return;
  for (int i = 0; i < KINDS; ++i) fprintf(file, "%s %ld\n", kNames[i], counts[i]);
  fprintf(file, "any %ld\n", counts[KINDS]);
  fclose(file);
}

/* Counts a call. Gives the errno with which it must fail, -1 if it must be short, 0 if nothing is wrong. */
static int fault(int call) {
  read_order();
  pthread_mutex_lock(&mutex);
  const long mine = ++counts[call];
  const long all = call < MMAP ? ++counts[KINDS] : -1;
  const int hit = (kind == call && mine == wanted) || (kind == KINDS && all == wanted);
  if (hit && effect == kKill) raise(SIGKILL);
  if (hit && tracks()) cut_power();
  pthread_mutex_unlock(&mutex);
  if (!hit) return 0;
  return effect == kShort ? -1 : effect == kErrno ? number : 0;
}

static int counted_path(const char* path) { return path != NULL && path[0] != '/'; }
static int counted(int file) { return file >= 0 && file < kMostFiles && files[file].used; }

static void opened(int file, const char* path, int flags, int is_new) {
  if (file < 0 || file >= kMostFiles) return;
  files[file].used = 1;
  files[file].writes = (flags & O_ACCMODE) != O_RDONLY;
  snprintf(files[file].path, kLongest, "%s", path);
  if (!tracks() || !is_new) return;
  pthread_mutex_lock(&mutex);
  new_change(kMade, path, "");
  pthread_mutex_unlock(&mutex);
}

static int open_counted(const char* path, int flags, mode_t mode) {
  const int number = fault(OPEN);
  if (number > 0) return errno = number, -1;
  const int is_new = (flags & O_CREAT) != 0 && access(path, F_OK) != 0;
  const int file = (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
  opened(file, path, flags, is_new);
  return file;
}

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  if (counted_path(path)) return open_counted(path, flags, mode);
  return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}
int open64(const char* path, int flags, ...) __attribute__((alias("open")));

DIR* opendir(const char* path) {
  const int number = counted_path(path) ? fault(OPEN) : 0;
  if (number > 0) return errno = number, NULL;
  return REAL(opendir)(path);
}

static FILE* open_stream(const char* path, const char* mode) {
  const int number = counted_path(path) ? fault(OPEN) : 0;
  if (number > 0) return errno = number, NULL;
  FILE* stream = REAL(fopen)(path, mode);
  if (stream != NULL && counted_path(path)) opened(fileno(stream), path, O_RDONLY, 0);
  return stream;
}
FILE* fopen(const char* path, const char* mode) { return open_stream(path, mode); }
FILE* fopen64(const char* path, const char* mode) { return open_stream(path, mode); }

int close(int file) {
  if (file >= 0 && file < kMostFiles) files[file].used = 0;
  return (int)syscall(SYS_close, file);
}

ssize_t read(int file, void* bytes, size_t size) {
  const int number = counted(file) ? fault(READ) : 0;
  if (number > 0) return errno = number, -1;
  return syscall(SYS_read, file, bytes, number < 0 && size > 1 ? 1 : size);
}

ssize_t write(int file, const void* bytes, size_t size) {
  const int number = counted(file) ? fault(WRITE) : 0;
  if (number > 0) return errno = number, -1;
  if (counted(file) && tracks()) {
    pthread_mutex_lock(&mutex);
    written_of(files[file].path)->dirty = 1;
    pthread_mutex_unlock(&mutex);
  }
  return syscall(SYS_write, file, bytes, number < 0 && size > 1 ? 1 : size);
}

int fsync(int file) {
  const int number = counted(file) ? fault(FSYNC) : 0;
  if (number > 0) return errno = number, -1;
  if (counted(file) && tracks()) {
    pthread_mutex_lock(&mutex);
    struct stat what;
    char folder[kLongest];
    fstat(file, &what);
    for (int i = 0; i < change_count; ++i) {
      folder_of(changes[i].kind == kRenamed ? changes[i].to : changes[i].from, folder);
      if (S_ISDIR(what.st_mode) && strcmp(folder, files[file].path) == 0) changes[i].lost = 0;
    }
    if (S_ISREG(what.st_mode)) {
      struct written* written = written_of(files[file].path);
      written->synced = what.st_size;
      written->dirty = 0;
    }
    pthread_mutex_unlock(&mutex);
  }
  return (int)syscall(SYS_fsync, file);
}

int rename(const char* from, const char* to) {
  const int number = counted_path(from) ? fault(RENAME) : 0;
  if (number > 0) return errno = number, -1;
  if (!tracks() || !counted_path(from)) return (int)syscall(SYS_rename, from, to);
  pthread_mutex_lock(&mutex);
  struct change* change = new_change(kRenamed, from, to);
  save(change, to);
  const int result = (int)syscall(SYS_rename, from, to);
  if (result != 0) change->lost = 0;
  if (result == 0) move_tree(from, to);
  pthread_mutex_unlock(&mutex);
  return result;
}

int mkdir(const char* path, mode_t mode) {
  const int number = counted_path(path) ? fault(MKDIR) : 0;
  if (number > 0) return errno = number, -1;
  const int result = (int)syscall(SYS_mkdir, path, mode);
  if (result == 0 && tracks() && counted_path(path)) {
    pthread_mutex_lock(&mutex);
    new_change(kMadeFolder, path, "");
    pthread_mutex_unlock(&mutex);
  }
  return result;
}

int unlink(const char* path) {
  const int number = counted_path(path) ? fault(UNLINK) : 0;
  if (number > 0) return errno = number, -1;
  if (tracks() && counted_path(path)) {
    pthread_mutex_lock(&mutex);
    save(new_change(kRemoved, path, ""), path);
    pthread_mutex_unlock(&mutex);
  }
  return (int)syscall(SYS_unlink, path);
}

int flock(int file, int operation) {
  const int number = counted(file) ? fault(FLOCK) : 0;
  if (number > 0) return errno = number, -1;
  return (int)syscall(SYS_flock, file, operation);
}

void* mmap(void* at, size_t size, int protection, int flags, int file, off_t offset) {
  const int number = (protection & PROT_EXEC) != 0 && (flags & MAP_ANONYMOUS) != 0 ? fault(MMAP) : 0;
  if (number > 0) return errno = number, MAP_FAILED;
  return (void*)syscall(SYS_mmap, at, size, protection, flags, file, offset);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*), void* argument) {
  const int number = fault(THREAD);
  if (number > 0) return number;
  return REAL(pthread_create)(thread, attributes, work, argument);
}

/* Allocations count from main on: those before it are of the libraries, which know no sentence. */
static int in_main;
static int (*real_main)(int, char**, char**);

static int counted_main(int argc, char** argv, char** environment) {
  in_main = 1;
  return real_main(argc, argv, environment);
}

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(void), void (*fini)(void),
                      void (*rtld_fini)(void), void* stack_end) {
  real_main = main;
  return REAL(__libc_start_main)(counted_main, argc, argv, init, fini, rtld_fini, stack_end);
}

/* A size that nobody has: the real operator new throws std::bad_alloc of it. */
static size_t size_or_fault(size_t size) { return in_main && fault(NEW) > 0 ? ~(size_t)0 >> 1 : size; }

void* _Znwm(size_t size) { /* operator new(std::size_t) */
  static void* (*real)(size_t);
  if (real == NULL) real = (void* (*)(size_t))dlsym(RTLD_NEXT, "_Znwm");
  return real(size_or_fault(size));
}

void* _ZnwmSt11align_val_t(size_t size, size_t alignment) { /* operator new(std::size_t, std::align_val_t) */
  static void* (*real)(size_t, size_t);
  if (real == NULL) real = (void* (*)(size_t, size_t))dlsym(RTLD_NEXT, "_ZnwmSt11align_val_t");
  return real(size_or_fault(size), alignment);
}
