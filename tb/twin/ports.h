/* SPDX-License-Identifier: BSD-2-Clause */
/** Where hosts connect: a pseudo-terminal and a TCP port of this machine, both ends of one serial line. */
#ifndef TWIN_PORTS_H
#define TWIN_PORTS_H

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace twin {

class Ports {
public:
    /** @param tcp_port  On the loopback interface; 0: any that is free. @throws std::system_error */
    explicit Ports(uint16_t tcp_port);
    ~Ports();
    Ports(const Ports &) = delete;

    const std::string &path() const { return path_; }
    uint16_t tcp_port() const { return tcp_port_; }

    /** Wait for something to read, a host that connects, or the end of the time. */
    void wait(int64_t ns);

    /** Bytes from whoever sent some, at most `size`, without waiting. */
    size_t read(uint8_t *bytes, size_t size);

    /** A byte for everybody who listens; kept for those who are slow, the last 64 KiB. */
    void write(uint8_t byte);

    /** Hand on what write() collected. */
    void flush();

private:
    struct End {
        int fd;
        std::string unread;
        bool gone = false;
    };

    void accept_new();
    void drop_gone();

    std::string path_;
    uint16_t tcp_port_ = 0;
    int terminal_ = -1; /* kept open, so that the pty stays when a host leaves */
    int listener_ = -1;
    std::vector<End> ends_; /* the pty's first */
};

} // namespace twin

#endif
