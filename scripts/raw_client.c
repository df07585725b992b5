/* A client of Player's protocol in C, for scripts/bench: raw_client HOST PORT

   Reads position2d, laser and blobfinder in pull mode and answers each round with a velocity.
   Like Player's own library it writes a command and a request for data one after the other. */
#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { HEADER = 40, BANNER = 32, MOST = 1 << 20 };
enum { PLAYER = 1, POSITION2D = 4, LASER = 6, BLOBFINDER = 7 };
enum { DATA = 1, CMD = 2, REQ = 3, ACK = 4, SYNCH = 5 };

static unsigned char in[MOST];
static size_t filled, taken;
static int link_;

static void put32(unsigned char *at, uint32_t number) {
    number = htonl(number);
    memcpy(at, &number, 4);
}

static uint32_t get32(const unsigned char *at) {
    uint32_t number;
    memcpy(&number, at, 4);
    return ntohl(number);
}

static void put_double(unsigned char *at, double number) {
    uint64_t bits;
    memcpy(&bits, &number, 8);
    put32(at, (uint32_t)(bits >> 32));
    put32(at + 4, (uint32_t)bits);
}

static float get_float(const unsigned char *at) {
    uint32_t bits = get32(at);
    float number;
    memcpy(&number, &bits, 4);
    return number;
}

/* Have so many bytes at in + taken; the run is over when there are no more. */
static void need(size_t bytes) {
    if (taken > 0 && taken == filled)
        taken = filled = 0;
    if (taken + bytes > MOST) {
        memmove(in, in + taken, filled - taken);
        filled -= taken;
        taken = 0;
    }
    while (filled - taken < bytes) {
        ssize_t got = read(link_, in + filled, MOST - filled);
        if (got <= 0)
            exit(0);
        filled += (size_t)got;
    }
}

static void say(uint32_t interf, uint32_t type, uint32_t subtype, const unsigned char *payload,
                uint32_t size) {
    unsigned char out[HEADER + 64] = {0};
    put32(out + 8, interf);
    put32(out + 16, type);
    put32(out + 20, subtype);
    put32(out + 36, size);
    if (size)
        memcpy(out + HEADER, payload, size);
    if (write(link_, out, HEADER + size) != (ssize_t)(HEADER + size))
        exit(0);
}

/* What the last scan says of the way ahead, in metres. */
static float ahead = 1e9f;

static void look(const unsigned char *scan) {
    ahead = 1e9f;
    for (uint32_t k = 60; k < 120 && k < get32(scan + 16); k++) {
        float range = get_float(scan + 24 + 4 * k);
        ahead = range < ahead ? range : ahead;
    }
}

/* Take messages until one of this type. */
static void read_until(uint32_t wanted) {
    for (;;) {
        need(HEADER);
        uint32_t interf = get32(in + taken + 8), type = get32(in + taken + 16);
        uint32_t size = get32(in + taken + 36);
        need(HEADER + size);
        if (interf == LASER && type == DATA)
            look(in + taken + HEADER);
        taken += HEADER + size;
        if (type == wanted)
            return;
    }
}

static void ask(uint32_t subtype, const uint32_t *numbers, int count) {
    unsigned char payload[64];
    for (int k = 0; k < count; k++)
        put32(payload + 4 * k, numbers[k]);
    say(PLAYER, REQ, subtype, payload, 4 * (uint32_t)count);
    read_until(ACK);
}

int main(int argc, char **argv) {
    struct addrinfo hints = {.ai_socktype = SOCK_STREAM}, *found;
    if (argc != 3 || getaddrinfo(argv[1], argv[2], &hints, &found) != 0)
        return 2;
    link_ = socket(found->ai_family, SOCK_STREAM, 0);
    if (connect(link_, found->ai_addr, found->ai_addrlen) != 0)
        return 1;
    need(BANNER);
    taken += BANNER;
    ask(5, (const uint32_t[]){2}, 1);                              /* data when asked for */
    ask(10, (const uint32_t[]){~0u, ~0u, 1, ~0u, 1}, 5);           /* the newest only */
    const uint32_t devices[] = {POSITION2D, LASER, BLOBFINDER};
    for (int k = 0; k < 3; k++)
        ask(3, (const uint32_t[]){0, 0, devices[k], 0, 1, 0, 0}, 7);
    for (;;) {
        say(PLAYER, REQ, 4, NULL, 0);
        read_until(SYNCH);
        unsigned char velocity[28] = {0};
        put_double(velocity, 0.4);
        put_double(velocity + 16, ahead > 1.5f ? 0.0 : 0.8);
        put32(velocity + 24, 1);
        say(POSITION2D, CMD, 1, velocity, sizeof velocity);
    }
}
