// A Slurm cluster of two nodes on this machine, for one test: its own daemons, ports, folder and users'
// commands.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <pwd.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/program.h"

namespace ricci::testing {

/// Everything that this process has started and that still runs, children of children too.
inline std::vector<pid_t> descendants() {
    std::multimap<pid_t, pid_t> children;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        const pid_t pid = std::atoi(entry.path().filename().c_str());
        if (pid == 0) continue;
        std::ifstream file(entry.path() / "stat");
        std::string stat;
        std::getline(file, stat);
        const std::size_t name_end = stat.rfind(')');  // the name may hold anything
        if (name_end == std::string::npos || name_end + 4 > stat.size()) continue;
        children.emplace(std::atoi(stat.c_str() + name_end + 4), pid);
    }
    std::vector<pid_t> found, open{getpid()};
    while (!open.empty()) {
        const auto [begin, end] = children.equal_range(open.back());
        open.pop_back();
        for (auto child = begin; child != end; ++child) {
            found.push_back(child->second);
            open.push_back(child->second);
        }
    }
    return found;
}

/// What is wrong with this machine for a SlurmCluster; empty when nothing is.
inline std::string no_slurm() {
    for (const char* program : {"slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "scancel", "sinfo"}) {
        const std::string command =
            std::string("PATH=$PATH:/usr/sbin command -v ") + program + " > /dev/null";
        if (std::system(command.c_str()) != 0)
            return std::string(program) +
                   " is not installed (Debian packages slurmctld, slurmd, slurm-client)";
    }
    return {};
}

class SlurmCluster {
  public:
    /// Starts the daemons and waits until both nodes are idle. The environment variable RICCI_SLURM_DEFAULTS
    /// leaves Slurm's own times for noticing a dead node and for starting its jobs again (minutes); otherwise
    /// they are as short as they can be. Throws std::runtime_error when a daemon does not stay up.
    SlurmCluster() {
        // Orphans of the daemons stay within reach.
        prctl(PR_SET_CHILD_SUBREAPER, 1);
        write_configuration();
        setenv("SLURM_CONF", (folder_ / "slurm.conf").c_str(), 1);
        try {
            controller_ = start({"slurmctld", "-D"}, "slurmctld.out");
            for (const char* node : {"n1", "n2"})
                nodes_[node] = start({"slurmd", "-D", "-N", node}, std::string(node) + ".out");
            wait_until([&] { return output("sinfo -h -N -o %T 2> /dev/null") == "idle\nidle\n"; });
        } catch (...) {
            stop();
            throw;
        }
    }
    ~SlurmCluster() { stop(); }
    SlurmCluster(const SlurmCluster&) = delete;
    SlurmCluster& operator=(const SlurmCluster&) = delete;

    /// What a command prints.
    static std::string output(const std::string& command) {
        std::FILE* pipe = popen(command.c_str(), "r");
        if (pipe == nullptr) throw std::runtime_error("cannot run " + command);
        std::string text;
        std::array<char, 512> buffer{};
        while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) text += buffer.data();
        pclose(pipe);
        return text;
    }

    /// Far beyond what anything here takes, on a busy machine too.
    static std::chrono::seconds patience() {
        return std::chrono::seconds(std::getenv("RICCI_SLURM_DEFAULTS") != nullptr ? 1200 : 400);
    }

    /// What the jobs are doing, and the ends of the daemons' logs.
    [[nodiscard]] std::string state() const {
        std::string text = output("squeue -t all 2>&1; sinfo -N 2>&1");
        for (const char* log : {"slurmctld.out", "slurmctld.log", "n1.out", "n1.log", "n2.out", "n2.log"}) {
            const std::string all = read_text(folder_ / log);
            text += std::string("--- ") + log + "\n" +
                    all.substr(all.size() - std::min<std::size_t>(all.size(), 3000));
        }
        return text;
    }

    /// Polls. Throws when the controller ends before, or when it takes longer than patience().
    void wait_until(const std::function<bool()>& condition) const {
        const auto start = std::chrono::steady_clock::now();
        while (!condition()) {
            if (std::chrono::steady_clock::now() - start > patience())
                throw std::runtime_error("waited " + std::to_string(patience().count()) + " s in vain:\n" +
                                         state());
            if (waitpid(controller_, nullptr, WNOHANG) == controller_)
                throw std::runtime_error("slurmctld ended:\n" + read_text(folder_ / "slurmctld.out") +
                                         read_text(folder_ / "slurmctld.log"));
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
    }

    /// The state of a job that has ended, like COMPLETED; waits for that. One that does not end: its state
    /// and how long that took, for the test to show with the job's own logs.
    [[nodiscard]] std::string wait_for_job(const std::string& job) const {
        std::string state;
        const auto start = std::chrono::steady_clock::now();
        bool given_up = false;
        wait_until([&] {
            state = output("squeue -h -t all -o %T -j " + job);
            state = state.substr(0, state.find('\n'));
            static const std::set<std::string> kUnderWay{
                "PENDING", "RUNNING", "COMPLETING", "CONFIGURING", "REQUEUED", "SUSPENDED", ""};
            given_up = std::chrono::steady_clock::now() - start > patience() - std::chrono::seconds(10);
            return given_up || !kUnderWay.contains(state);
        });
        return given_up ? state + " after " + std::to_string(patience().count()) + " s" : state;
    }

    /// The power failure of a node: its daemon, the step's and the job's processes are gone at once.
    void kill_node(const std::string& node) {
        std::set<pid_t> victims{nodes_.at(node)};
        const std::string mark = "SLURMD_NODENAME=" + node + '\0';
        for (const pid_t pid : descendants()) {
            const std::string process = "/proc/" + std::to_string(pid);
            if (read_text(process + "/environ").find(mark) == std::string::npos) continue;
            victims.insert(pid);
            // Its parents up to the daemon of the step.
            for (pid_t parent = parent_of(pid); parent > 1 && parent != getpid(); parent = parent_of(parent))
                if (read_text("/proc/" + std::to_string(parent) + "/comm").starts_with("slurmstepd"))
                    victims.insert(parent);
        }
        for (const pid_t pid : victims) kill(pid, SIGKILL);
    }

  private:
    /// Ends whatever is left, however deep; again while the dying have started others.
    static void stop() {
        for (std::vector<pid_t> left = descendants(); !left.empty(); left = descendants()) {
            for (const pid_t pid : left) kill(pid, SIGKILL);
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            while (waitpid(-1, nullptr, WNOHANG) > 0) {
            }
        }
        unsetenv("SLURM_CONF");
    }

    static pid_t parent_of(pid_t pid) {
        const std::string stat = read_text("/proc/" + std::to_string(pid) + "/stat");
        const std::size_t name_end = stat.rfind(')');
        return name_end == std::string::npos ? 0 : std::atoi(stat.c_str() + name_end + 4);
    }

    /// Ports that nobody listens on, found by asking the system for some.
    static std::vector<int> free_ports(std::size_t count) {
        std::vector<int> sockets, ports;
        for (std::size_t k = 0; k < count; ++k) {
            sockets.push_back(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
            sockaddr_in address{};
            address.sin_family = AF_INET;
            address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
            socklen_t size = sizeof address;
            if (bind(sockets.back(), reinterpret_cast<sockaddr*>(&address), size) != 0 ||
                getsockname(sockets.back(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
                throw std::runtime_error("no free port");
            ports.push_back(ntohs(address.sin_port));
        }
        for (const int s : sockets) close(s);
        return ports;
    }

    void write_configuration() const {
        std::array<char, 256> host{};
        gethostname(host.data(), host.size() - 1);
        const std::string name = std::string(host.data()).substr(0, std::string(host.data()).find('.'));
        const std::string user = getpwuid(geteuid())->pw_name;
        const std::vector<int> ports = free_ports(3);
        const bool defaults = std::getenv("RICCI_SLURM_DEFAULTS") != nullptr;
        std::filesystem::create_directory(folder_ / "state");
        std::string text = "ClusterName=test\nSlurmctldHost=" + name +
                           "(127.0.0.1)\nSlurmctldPort=" + std::to_string(ports[0]) + "\nSlurmUser=" + user +
                           "\nSlurmdUser=" + user +
                           "\n# For tests on one machine only: nobody proves who he is.\n"
                           "AuthType=auth/none\nCredType=cred/none\n"
                           "ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\n"
                           "JobAcctGatherType=jobacct_gather/none\nMpiDefault=none\n"
                           "SelectType=select/cons_tres\nSelectTypeParameters=CR_Core\n"
                           "SlurmdParameters=config_overrides\nJobRequeue=1\nReturnToService=2\nMinJobAge="
                           "86400\nMailProg=/bin/true\n";
        if (!defaults)
            text +=
                "SlurmdTimeout=3\nMessageTimeout=5\nAuthInfo=cred_expire=5\n"
                "SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0,bf_interval="
                "1\n";
        text += "StateSaveLocation=" + (folder_ / "state") +
                "\nSlurmctldPidFile=" + (folder_ / "slurmctld.pid") +
                "\nSlurmctldLogFile=" + (folder_ / "slurmctld.log") + "\nSlurmdSpoolDir=" + (folder_ / "%n") +
                "\nSlurmdPidFile=" + (folder_ / "%n.pid") + "\nSlurmdLogFile=" + (folder_ / "%n.log") + "\n";
        for (const std::size_t n : {1U, 2U})
            text += "NodeName=n" + std::to_string(n) + " NodeHostname=" + name +
                    " NodeAddr=127.0.0.1 Port=" + std::to_string(ports[n]) + " CPUs=1\n";
        text += "PartitionName=p Nodes=n1,n2 Default=YES\n";
        write_text(folder_ / "slurm.conf", text);
    }

    pid_t start(std::vector<std::string> words, const std::string& out) const {
        const std::string path = folder_ / out;
        std::vector<char*> argv;
        for (std::string& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        const pid_t parent = getpid(), child = fork();
        if (child != 0) return child;
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(127);
        const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        dup2(file, STDOUT_FILENO);
        dup2(file, STDERR_FILENO);
        const char* searched = std::getenv("PATH");
        setenv("PATH", (std::string(searched != nullptr ? searched : "/usr/bin:/bin") + ":/usr/sbin").c_str(),
               1);
        execvp(argv[0], argv.data());
        _exit(127);
    }

    TemporaryFolder folder_;
    pid_t controller_ = -1;
    std::map<std::string, pid_t> nodes_;
};

}  // namespace ricci::testing
