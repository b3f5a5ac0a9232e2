/* The reference firmware as a program: three simulated rails behind a pseudo-terminal, a UDP port or
 * shared memory. For tests, and for authors of drivers and boards.
 *
 *   frame_firmware serial            prints "at serial:/dev/pts/N"
 *   frame_firmware udp:PORT          127.0.0.1; 0: any port. Prints "at udp:127.0.0.1:PORT"
 *   frame_firmware shm:NAME          prints "at shm:NAME"
 *   ... silence_ms=N                 of the watchdog; 20 where nothing is said
 *   ... commanded                    no clock: a millisecond passes with every command heard
 *
 * It ticks 4,000 times a second, and prints a line whenever the phase changes: the phase, ms since
 * the last command was heard, the largest |effort - neutral| given, and the longest time between
 * two ticks since the last line, ms. SIGTERM and SIGINT end it. */
#define _DEFAULT_SOURCE
#define _XOPEN_SOURCE 700
#include "firmware.h"
#include "shared_ring.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

enum { AXES = 3, PERIOD_NS = 250000 };

typedef struct {
  int fd;              /* -1: shared memory */
  int line;            /* the other end of the pseudo-terminal, kept open; else -1 */
  int udp;
  struct sockaddr_in peer, last; /* owner of the session; last sender */
  sr_memory* shared;
  char shared_path[80];
  double position[AXES], velocity[AXES];
  float given[AXES];
} machine;

static volatile sig_atomic_t ended;
static void on_end(int signal) {
  (void)signal;
  ended = 1;
}

static int64_t now_ns(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static void measure(void* context, fw_state* state) {
  const machine* m = context;
  int i;
  for (i = 0; i < AXES; ++i) {
    state->position[i] = (float)m->position[i];
    state->effort[i] = m->given[i];
  }
  state->valid = (1u << AXES) - 1;
  state->status = WH_HOMED;
}

static void drive(void* context, const float* effort, int on) {
  machine* m = context;
  int i;
  for (i = 0; i < AXES; ++i) m->given[i] = on ? effort[i] : 0.0f;
}

/* Moves a free handle of 0.25 kg with 3 N.s/m between its stops. */
static void move(machine* m, double period_s) {
  static const double travel_m[AXES] = {0.06, 0.09, 0.07};
  int i;
  for (i = 0; i < AXES; ++i) {
    m->velocity[i] += period_s * ((double)m->given[i] - 3.0 * m->velocity[i]) / 0.25;
    m->position[i] += period_s * m->velocity[i];
    if (fabs(m->position[i]) > travel_m[i]) {
      m->position[i] = copysign(travel_m[i], m->position[i]);
      m->velocity[i] = 0.0;
    }
  }
}

static int32_t control(void* context, uint8_t verb, float argument) {
  (void)context;
  (void)argument;
  return verb == WH_IDENTIFY ? WH_OK : WH_UNSUPPORTED;
}

static void send_bytes(void* context, const uint8_t* bytes, size_t count) {
  machine* m = context;
  ssize_t sent = 0;
  if (m->shared != NULL) {
    sr_put(&m->shared->from_device, bytes, count);
  } else if (m->udp) {
    sent = sendto(m->fd, bytes, count, MSG_DONTWAIT, (struct sockaddr*)&m->peer, sizeof m->peer);
  } else {
    sent = write(m->fd, bytes, count);
  }
  (void)sent; /* bytes without room are lost, as on a line */
}

static size_t receive_bytes(machine* m, uint8_t* bytes, size_t capacity) {
  socklen_t length = sizeof m->last;
  ssize_t count;
  if (m->shared != NULL) return sr_get(&m->shared->to_device, bytes);
  if (m->udp) {
    count = recvfrom(m->fd, bytes, capacity, MSG_DONTWAIT, (struct sockaddr*)&m->last, &length);
  } else {
    count = read(m->fd, bytes, capacity);
  }
  return count > 0 ? (size_t)count : 0;
}

static int open_serial(machine* m) {
  struct termios raw;
  m->fd = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (m->fd < 0 || grantpt(m->fd) != 0 || unlockpt(m->fd) != 0) return 0;
  m->line = open(ptsname(m->fd), O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (m->line < 0 || tcgetattr(m->line, &raw) != 0) return 0;
  cfmakeraw(&raw);
  if (tcsetattr(m->line, TCSANOW, &raw) != 0) return 0;
  printf("at serial:%s\n", ptsname(m->fd));
  return 1;
}

static int open_udp(machine* m, int port) {
  struct sockaddr_in at = {0};
  socklen_t length = sizeof at;
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  at.sin_port = htons((uint16_t)port);
  m->udp = 1;
  m->fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (m->fd < 0 || bind(m->fd, (struct sockaddr*)&at, sizeof at) != 0) return 0;
  if (getsockname(m->fd, (struct sockaddr*)&at, &length) != 0) return 0;
  printf("at udp:127.0.0.1:%d\n", ntohs(at.sin_port));
  return 1;
}

static int open_shared(machine* m, const char* name) {
  int fd;
  m->fd = -1;
  snprintf(m->shared_path, sizeof m->shared_path, "/wholehand-frame-%s", name);
  shm_unlink(m->shared_path);
  fd = shm_open(m->shared_path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (fd < 0 || ftruncate(fd, sizeof(sr_memory)) != 0) return 0;
  m->shared = mmap(NULL, sizeof(sr_memory), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  close(fd);
  if (m->shared == MAP_FAILED) return 0;
  m->shared->layout = SR_LAYOUT;
  __atomic_store_n(&m->shared->magic, (uint32_t)SR_MAGIC, __ATOMIC_RELEASE);
  printf("at shm:%s\n", name);
  return 1;
}

static int open_carrier(machine* m, const char* where) {
  m->line = -1;
  if (strcmp(where, "serial") == 0) return open_serial(m);
  if (strncmp(where, "udp:", 4) == 0) return open_udp(m, atoi(where + 4));
  if (strncmp(where, "shm:", 4) == 0) return open_shared(m, where + 4);
  errno = EINVAL;
  return 0;
}

static fw_board board_of(machine* m, int silence_ms) {
  static const char* const names[AXES] = {"x", "y", "z"};
  static const float travel_m[AXES] = {0.06f, 0.09f, 0.07f};
  fw_board board;
  int i;
  memset(&board, 0, sizeof board);
  board.context = m;
  strcpy(board.name, "reference firmware");
  strcpy(board.serial, "none there");
  strcpy(board.firmware, "1.0");
  board.axes = AXES;
  for (i = 0; i < AXES; ++i) {
    wf_axis* axis = &board.axis[i];
    strcpy(axis->name, names[i]);
    axis->kind = WH_TRANSLATION;
    axis->effort_meaning = WH_EFFORT;
    axis->lower = -travel_m[i];
    axis->upper = travel_m[i];
    axis->effort_limit = 8.0f;
    axis->resolution = 2e-5f;
    axis->delay_s = 2e-9f * PERIOD_NS;
    axis->silence_s = (float)silence_ms * 1e-3f;
  }
  board.silence_us = (uint32_t)silence_ms * 1000u;
  board.measure = measure;
  board.drive = drive;
  board.control = control;
  board.send = send_bytes;
  return board;
}

/* Passes all received bytes on. The peer is the sender that began the session. */
static void hear(machine* m, firmware* fw, uint32_t now_us) {
  uint8_t bytes[512];
  size_t count;
  while ((count = receive_bytes(m, bytes, sizeof bytes)) > 0) {
    const uint32_t session = fw->session;
    const struct sockaddr_in peer = m->peer;
    m->peer = m->last; /* an answer goes to the sender of its question */
    firmware_receive(fw, bytes, count, now_us);
    if (fw->session == session && session != 0) m->peer = peer;
  }
}

static void tell_phase(const firmware* fw, uint32_t now_us, int64_t longest_ns) {
  static const char* const phases[] = {"off", "waiting", "rendering", "ramping", "latched"};
  double most = 0.0;
  int i;
  for (i = 0; i < AXES; ++i) most = fmax(most, fabs((double)fw->effort[i]));
  printf("%s %.3f %.9g %.3f\n", phases[fw->phase], (double)(now_us - fw->heard_us) * 1e-3, most,
         (double)longest_ns * 1e-6);
  fflush(stdout);
}

static void run(machine* m, const fw_board* board, int commanded) {
  firmware fw;
  int64_t next_ns = now_ns(), last_ns = next_ns, longest_ns = 0;
  uint32_t now_us = 0, heard = 0;
  fw_phase reported = FW_OFF;
  firmware_init(&fw, board);
  while (!ended) {
    if (commanded) {
      struct pollfd input = {0};
      input.fd = m->fd;
      input.events = POLLIN;
      if (m->shared == NULL) poll(&input, 1, 100);
      hear(m, &fw, now_us);
      if (fw.heard != heard && fw.phase == FW_RENDERING) now_us += 1000;
      if (fw.heard != heard && fw.phase == FW_RENDERING) move(m, 1e-3);
      if (fw.heard == heard) usleep(100);
      heard = fw.heard;
    } else {
      struct timespec at;
      next_ns += PERIOD_NS;
      if (now_ns() - next_ns > 1000000000) next_ns = now_ns(); /* after a stop of this process */
      at.tv_sec = next_ns / 1000000000;
      at.tv_nsec = next_ns % 1000000000;
      clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, NULL);
      now_us = (uint32_t)(now_ns() / 1000);
      hear(m, &fw, now_us);
      move(m, PERIOD_NS * 1e-9);
    }
    firmware_tick(&fw, now_us);
    if (now_ns() - last_ns > longest_ns) longest_ns = now_ns() - last_ns;
    last_ns = now_ns();
    if (fw.phase == reported) continue;
    tell_phase(&fw, now_us, longest_ns);
    reported = fw.phase;
    longest_ns = 0;
  }
}

int main(int argc, char** argv) {
  static machine m;
  const struct sched_param urgent = {85};
  fw_board board;
  int commanded = 0, silence_ms = 20, i;
  for (i = 2; i < argc; ++i) {
    if (strcmp(argv[i], "commanded") == 0) {
      commanded = 1;
    } else if (sscanf(argv[i], "silence_ms=%d", &silence_ms) != 1 || silence_ms < 1) {
      argc = 0;
    }
  }
  if (argc < 2) {
    fprintf(stderr,
            "usage: frame_firmware serial | udp:PORT | shm:NAME [silence_ms=N] [commanded]\n");
    return 2;
  }
  if (!open_carrier(&m, argv[1])) {
    fprintf(stderr, "frame_firmware: %s: %s\n", argv[1], strerror(errno));
    return 2;
  }
  fflush(stdout);
  signal(SIGTERM, on_end);
  signal(SIGINT, on_end);
  (void)sched_setscheduler(0, SCHED_FIFO, &urgent); /* if the machine allows it */
  board = board_of(&m, silence_ms);
  run(&m, &board, commanded);
  if (m.shared != NULL) shm_unlink(m.shared_path);
  return 0;
}
