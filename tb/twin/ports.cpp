/* SPDX-License-Identifier: BSD-2-Clause */
#include "ports.h"

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pty.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

namespace twin {

namespace {

constexpr size_t UNREAD_BYTES = 1 << 16;

int must(int result, const char *what)
{
    if (result < 0)
        throw std::system_error(errno, std::generic_category(), what);
    return result;
}

void make_nonblocking(int fd)
{
    must(fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK), "fcntl");
}

} // namespace

Ports::Ports(uint16_t tcp_port)
{
    int master;
    char name[256];
    termios raw{};
    cfmakeraw(&raw);
    must(openpty(&master, &terminal_, name, &raw, nullptr), "openpty");
    make_nonblocking(master);
    path_ = name;
    ends_.push_back({master, {}});

    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(tcp_port);
    socklen_t size = sizeof address;
    const int on = 1;
    listener_ = must(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), "socket");
    setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    must(bind(listener_, reinterpret_cast<sockaddr *>(&address), size), "TCP port");
    must(listen(listener_, 4), "TCP port");
    must(getsockname(listener_, reinterpret_cast<sockaddr *>(&address), &size), "TCP port");
    tcp_port_ = ntohs(address.sin_port);
}

Ports::~Ports()
{
    for (const End &end : ends_)
        close(end.fd);
    close(terminal_);
    close(listener_);
}

void Ports::wait(int64_t ns)
{
    std::vector<pollfd> files{{listener_, POLLIN, 0}};
    for (const End &end : ends_)
        files.push_back({end.fd, POLLIN, 0});
    const timespec time{ns / 1000000000, ns % 1000000000};
    if (ppoll(files.data(), files.size(), &time, nullptr) > 0 && files[0].revents)
        accept_new();
}

void Ports::accept_new()
{
    const int fd = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    const int on = 1;
    if (fd < 0)
        return;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    ends_.push_back({fd, {}});
}

size_t Ports::read(uint8_t *bytes, size_t size)
{
    size_t count = 0;
    for (size_t n = 0; n < ends_.size() && count < size; n++) {
        const ssize_t got = ::read(ends_[n].fd, bytes + count, size - count);
        if (got > 0)
            count += size_t(got);
        else if (n > 0 && (got == 0 || (errno != EAGAIN && errno != EINTR)))
            ends_[n].gone = true;
    }
    drop_gone();
    return count;
}

void Ports::write(uint8_t byte)
{
    for (End &end : ends_) {
        if (end.unread.size() == UNREAD_BYTES)
            end.unread.erase(0, 1);
        end.unread.push_back(char(byte));
    }
}

void Ports::flush()
{
    for (size_t n = 0; n < ends_.size(); n++) {
        End &end = ends_[n];
        if (end.unread.empty())
            continue;
        const ssize_t sent = n == 0 ? ::write(end.fd, end.unread.data(), end.unread.size())
                                    : send(end.fd, end.unread.data(), end.unread.size(), MSG_NOSIGNAL);
        if (sent > 0)
            end.unread.erase(0, size_t(sent));
        else if (n > 0 && errno != EAGAIN && errno != EINTR)
            end.gone = true;
    }
    drop_gone();
}

void Ports::drop_gone()
{
    for (const End &end : ends_)
        if (end.gone)
            close(end.fd);
    ends_.erase(std::remove_if(ends_.begin(), ends_.end(), [](const End &end) { return end.gone; }), ends_.end());
}

} // namespace twin
