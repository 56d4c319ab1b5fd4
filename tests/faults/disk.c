// Faults of a disk: loaded into a program (LD_PRELOAD), it counts the program's calls below a folder and lets one of
// them go wrong, or all from one on. Built by `tests/faults/disk.rs`.
//
// FAULTS_FOLDER   the folder, an absolute path
// FAULTS_PROGRAM  the program's name; others that it starts are let be
// FAULTS_LOG      a file that gets a line for each call: its number, its name, its path
// FAULTS_AT       the number of the call that goes wrong, from 0
// FAULTS_KIND     kill (before the call), killed (after it), stop (SIGSTOP before it), fail, lost (it is done and
//                 fails all the same), half (half of the bytes are read or written), clock (from then on it is so many
//                 seconds earlier)
// FAULTS_CODE     the error's number, or the seconds
// FAULTS_ON       if it is there, all calls that write from that one on go wrong
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))
#define HANDLES 65536

enum kind { NONE, KILL, KILLED, STOP, FAIL, LOST, HALF, CLOCK };
static const char *const KINDS[] = {"none", "kill", "killed", "stop", "fail", "lost", "half", "clock"};

static const char *folder;
static size_t folder_length;
static enum kind kind;
static long at = -1;
static int code, goes_on, log_handle = -1;
static atomic_long next;
static atomic_int seconds_back;
static atomic_char is_below[HANDLES];

__attribute__((constructor)) static void start(void) {
    const char *program = getenv("FAULTS_PROGRAM"), *log = getenv("FAULTS_LOG"), *which = getenv("FAULTS_KIND");
    if (!program || strcmp(program, program_invocation_short_name) != 0) return;
    const char *number = getenv("FAULTS_AT"), *error = getenv("FAULTS_CODE");
    at = number ? atol(number) : -1;
    code = error ? atoi(error) : 0;
    goes_on = getenv("FAULTS_ON") != NULL;
    for (int i = 0; which && i <= CLOCK; i++)
        if (strcmp(which, KINDS[i]) == 0) kind = i;
    if (log) log_handle = REAL(open)(log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    folder = getenv("FAULTS_FOLDER");
    folder_length = folder ? strlen(folder) : 0;
}

static int lies_below(const char *path) {
    return folder && path && strncmp(path, folder, folder_length) == 0
        && (path[folder_length] == '/' || path[folder_length] == 0);
}

static int is_of(int handle) { return folder && handle >= 0 && handle < HANDLES && is_below[handle]; }

static int writes(const char *name) {
    static const char *const NAMES[] = {"create", "write", "sync", "rename", "link", "remove", "make"};
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++)
        if (strcmp(name, NAMES[i]) == 0) return 1;
    return 0;
}

// Counts a call, and says what goes wrong with it.
static enum kind count(const char *name, const char *path) {
    long number = atomic_fetch_add(&next, 1);
    if (log_handle >= 0) dprintf(log_handle, "%ld %s %s\n", number, name, path);
    if (at < 0 || number < at || (number > at && !(goes_on && writes(name)))) return NONE;
    if (kind == KILL) raise(SIGKILL);
    if (kind == STOP) raise(SIGSTOP);
    if (kind == CLOCK) seconds_back = code;
    return kind;
}

// What a call returns that was done.
static long done(enum kind wrong, long answer) {
    if (wrong == KILLED) raise(SIGKILL);
    if (wrong != LOST || answer < 0) return answer;
    errno = code;
    return -1;
}

// Lets a call go wrong, or makes it.
#define MAKE(name, path, call)                             \
    do {                                                   \
        enum kind wrong = count(name, path);               \
        if (wrong == FAIL) {                               \
            errno = code;                                  \
            return -1;                                     \
        }                                                  \
        return done(wrong, call);                          \
    } while (0)

static int opened(int handle, const char *name, enum kind wrong) {
    if (handle >= 0 && handle < HANDLES) is_below[handle] = name != NULL;
    if (wrong == KILLED) raise(SIGKILL);
    if (wrong != LOST || handle < 0) return handle;
    REAL(close)(handle);
    errno = code;
    return -1;
}

#define OPEN(call)                                                     \
    do {                                                               \
        mode_t mode = 0;                                               \
        if (flags & (O_CREAT | O_TMPFILE)) {                           \
            va_list rest;                                              \
            va_start(rest, flags);                                     \
            mode = va_arg(rest, mode_t);                               \
            va_end(rest);                                              \
        }                                                              \
        if (!lies_below(path)) return opened(call, NULL, NONE);        \
        const char *name = flags & O_CREAT ? "create" : "open";        \
        enum kind wrong = count(name, path);                           \
        if (wrong == FAIL) {                                           \
            errno = code;                                              \
            return -1;                                                 \
        }                                                              \
        return opened(call, name, wrong);                              \
    } while (0)

int open(const char *path, int flags, ...) { OPEN(REAL(open)(path, flags, mode)); }
int open64(const char *path, int flags, ...) { OPEN(REAL(open64)(path, flags, mode)); }
int openat(int at_handle, const char *path, int flags, ...) { OPEN(REAL(openat)(at_handle, path, flags, mode)); }
int openat64(int at_handle, const char *path, int flags, ...) { OPEN(REAL(openat64)(at_handle, path, flags, mode)); }

int close(int handle) {
    if (handle >= 0 && handle < HANDLES) is_below[handle] = 0;
    return REAL(close)(handle);
}

#define TRANSFER(name, call)                                           \
    do {                                                               \
        if (!is_of(handle)) return call;                               \
        enum kind wrong = count(name, "");                             \
        if (wrong == FAIL) {                                           \
            errno = code;                                              \
            return -1;                                                 \
        }                                                              \
        if (wrong == HALF && length > 1) length /= 2;                  \
        return done(wrong, call);                                      \
    } while (0)

ssize_t read(int handle, void *bytes, size_t length) { TRANSFER("read", REAL(read)(handle, bytes, length)); }
ssize_t write(int handle, const void *bytes, size_t length) { TRANSFER("write", REAL(write)(handle, bytes, length)); }
ssize_t pread64(int handle, void *bytes, size_t length, off64_t from) {
    TRANSFER("read", REAL(pread64)(handle, bytes, length, from));
}
ssize_t writev(int handle, const struct iovec *parts, int number) {
    if (!is_of(handle)) return REAL(writev)(handle, parts, number);
    MAKE("write", "", REAL(writev)(handle, parts, number));
}
int fsync(int handle) {
    if (!is_of(handle)) return REAL(fsync)(handle);
    MAKE("sync", "", REAL(fsync)(handle));
}

#define ON_PATH(name, path, call)              \
    do {                                       \
        if (!lies_below(path)) return call;    \
        MAKE(name, path, call);                \
    } while (0)

int rename(const char *from, const char *to) { ON_PATH("rename", to, REAL(rename)(from, to)); }
int link(const char *from, const char *to) { ON_PATH("link", to, REAL(link)(from, to)); }
int linkat(int a, const char *from, int b, const char *to, int flags) {
    ON_PATH("link", to, REAL(linkat)(a, from, b, to, flags));
}
int unlink(const char *path) { ON_PATH("remove", path, REAL(unlink)(path)); }
int unlinkat(int handle, const char *path, int flags) { ON_PATH("remove", path, REAL(unlinkat)(handle, path, flags)); }
int mkdir(const char *path, mode_t mode) { ON_PATH("make", path, REAL(mkdir)(path, mode)); }
int rmdir(const char *path) { ON_PATH("remove", path, REAL(rmdir)(path)); }
int statx(int handle, const char *path, int flags, unsigned mask, struct statx *about) {
    ON_PATH("look", path, REAL(statx)(handle, path, flags, mask, about));
}

DIR *opendir(const char *path) {
    if (!lies_below(path)) return REAL(opendir)(path);
    enum kind wrong = count("list", path);
    if (wrong == FAIL || wrong == LOST) {
        errno = code;
        return NULL;
    }
    DIR *listed = REAL(opendir)(path);
    if (wrong == KILLED) raise(SIGKILL);
    return listed;
}

int clock_gettime(clockid_t clock, struct timespec *now) {
    int answer = REAL(clock_gettime)(clock, now);
    if (clock == CLOCK_REALTIME) now->tv_sec -= seconds_back;
    return answer;
}
