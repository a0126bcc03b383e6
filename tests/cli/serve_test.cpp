// delio-slam --serve: the map in a browser while the drive goes on.
#include <gtest/gtest.h>
#include <mrpt/img/CImage.h>

#include <cstring>
#include <memory>
#include <regex>
#include <set>

#include "delio_slam_fixture.h"
#include "http_ends.h"
#include "udp_sender.h"
#include "virtual_display.h"

namespace {
using namespace delio;
using test::Bytes;
using test::httpGet;
using test::readText;
using test::Words;
using test::operator+;
namespace fs = std::filesystem;

std::string bodyOf(const std::string& answer) {
    const auto head = answer.find("\r\n\r\n");
    return head == answer.npos ? "" : answer.substr(head + 4);
}

struct News {
    mrpt::containers::yaml head;  //!< JSON is YAML
    std::vector<float> numbers;

    std::size_t count(const std::string& name) const { return head[name].as<std::size_t>(); }
};

News newsOf(const std::string& answer) {
    const std::string body = bodyOf(answer);
    const auto end = body.find('\n');
    News news{mrpt::containers::yaml::FromText(body.substr(0, end)), {}};
    news.numbers.resize((body.size() - end - 1) / sizeof(float));
    std::memcpy(news.numbers.data(), &body[end + 1], news.numbers.size() * sizeof(float));
    return news;
}

/** A live VLP-16, whose drive ends with a signal. */
class Serve : public test::DelioSlam {
 protected:
    void start() {
        run_ = std::make_unique<test::RunningTool>(
            "delio-slam", Words{"-i", "udp://127.0.0.1:" + std::to_string(sensorPort_), "-o", out_,
                                "--no-map", "--queue", "1000", "--serve", "0"});
        ASSERT_TRUE(test::waitForListener(sensorPort_)) << run_->err();
        findPort();
    }

    void findPort() {
        const std::regex where("the map is at http://127.0.0.1:([0-9]+)/");
        std::smatch found;
        std::string said;
        while (!std::regex_search(said = run_->err(), found, where)) {
            ASSERT_FALSE(run_->hasEnded()) << said;
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        port_ = static_cast<std::uint16_t>(std::stoi(found[1]));
    }

    void drive() {
        const std::string all =
            readText((test::dataFolder() / "mrpt/vlp16_packets_1206.bin").string());
        for (std::size_t at = 0; at + 1206 <= all.size(); at += 1206) {
            const auto begin = all.begin() + static_cast<std::ptrdiff_t>(at);
            sensor_.send(Bytes(begin, begin + 1206), sensorPort_);
            std::this_thread::sleep_for(std::chrono::microseconds(300));
        }
    }

    /** News since nothing, once there are so many scans. */
    News afterScans(std::size_t scans) {
        for (int i = 0; i < 3000 && !run_->hasEnded(); ++i) {
            auto news = newsOf(httpGet(port_, "/live"));
            if (news.count("scans") >= scans) return news;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        ADD_FAILURE() << run_->err();
        return newsOf(httpGet(port_, "/live"));
    }

    void end() {
        run_->send(SIGTERM);
        const auto ended = run_->wait();
        EXPECT_EQ(ended.exitCode, 0) << ended.err;
    }

    const std::uint16_t sensorPort_ = test::freePort();
    const test::UdpEnd sensor_;
    std::unique_ptr<test::RunningTool> run_;
    std::uint16_t port_ = 0;
};

TEST_F(Serve, TheMapGrowsWhileDriving) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    start();
    const std::string page = httpGet(port_, "/");
    EXPECT_EQ(page.rfind("HTTP/1.1 200 OK\r\n", 0), 0U);
    EXPECT_EQ(bodyOf(page).rfind("<!DOCTYPE html>", 0), 0U);
    EXPECT_EQ(page.find("src=\"http"), std::string::npos);
    EXPECT_NE(page.find("connect-src 'self'"), std::string::npos);
    const auto before = newsOf(httpGet(port_, "/live"));
    EXPECT_EQ(before.count("all"), 0U);
    EXPECT_EQ(before.count("scans"), 0U);
    drive();
    const auto all = afterScans(8);
    EXPECT_GT(all.count("points"), 300U);  // it stands
    ASSERT_EQ(all.numbers.size(), 3 * all.count("poses") + 4 * all.count("points"));
    std::size_t high = 0, odd = 0;
    for (std::size_t i = 3 * all.count("poses"); i < all.numbers.size(); i += 4) {
        high += all.numbers[i + 3] > 0.5F;
        odd += !(all.numbers[i + 3] > -5 && all.numbers[i + 3] < 60);
    }
    EXPECT_GT(high, all.count("points") / 20);
    EXPECT_EQ(odd, 0U);
    // Only what is new; all of it where the viewer has another map.
    const auto since = [&](const std::string& generation) {
        return newsOf(httpGet(port_, "/live?generation=" + generation + "&points=" +
                                         std::to_string(all.count("points")) + "&poses=0"));
    };
    const std::string now = all.head["generation"].as<std::string>();
    EXPECT_EQ(since(now).count("first"), all.count("points"));
    EXPECT_EQ(since("999").count("first"), 0U);
    end();
    EXPECT_EQ(httpGet(port_, "/"), "");
}

TEST_F(Serve, RefusesWhatItDoesNotServe) {
    start();
    const auto statusOf = [&](const std::string& text) {
        const test::HttpClient client(port_);
        client.send(text);
        const std::string answer = client.receive();
        return answer.size() < 12 ? "" : answer.substr(9, 3);
    };
    const std::string host = " HTTP/1.1\r\nHost: localhost:1\r\n";
    EXPECT_EQ(statusOf("GET /" + host + "\r\n"), "200");
    EXPECT_EQ(statusOf("GET /summary.yaml" + host + "\r\n"), "404");
    EXPECT_EQ(statusOf("GET /../../etc/passwd" + host + "\r\n"), "404");
    EXPECT_EQ(
        statusOf("GET /live?points=-1&poses=x&generation=99999999999999999999" + host + "\r\n"),
        "200");
    EXPECT_EQ(statusOf("POST /live" + host + "\r\n"), "405");
    EXPECT_EQ(statusOf("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"), "403");
    EXPECT_EQ(statusOf("GET / HTTP/1.1\r\n\r\n"), "403");
    EXPECT_EQ(statusOf("nonsense\r\n\r\n"), "400");
    EXPECT_EQ(statusOf(std::string("\x16\x03\x01\x00\r\n\r\n", 8)), "400");
    EXPECT_EQ(statusOf("GET /" + host + "X: " + std::string(20000, 'x')), "431");
    run_->send(SIGTERM);
    EXPECT_EQ(run_->wait().exitCode, 130);
}

TEST_F(Serve, ClientsThatWaitHoldUpNobody) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    start();
    // Half a request each; and some that never read the page.
    std::vector<std::unique_ptr<test::HttpClient>> slow;
    for (int i = 0; i < 20; ++i) {
        slow.push_back(std::make_unique<test::HttpClient>(port_));
        slow.back()->send(i % 2 ? "GET / HT" : "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
    }
    drive();
    const auto news = afterScans(8);
    EXPECT_GT(news.count("points"), 300U);
    EXPECT_EQ(bodyOf(httpGet(port_, "/")).rfind("<!DOCTYPE html>", 0), 0U);
    end();
    EXPECT_EQ(summary()["live"]["scans_dropped"].as<int>(), 0);
}

TEST_F(Serve, APortInUseOrWrong) {
    const test::HttpEnd taken("x");
    const std::string port = std::to_string(taken.port());
    writeDrive(3);
    expectRefused(slam({"--serve", port}), 1, {"port " + port, "--serve"});
    expectRefused(slam({"--serve", "65536"}), 2, {"--serve", "65535"});
}

TEST_F(Serve, ARecordingIsServedAndGivesTheSameResults) {
    writeDrive(20);
    ASSERT_EQ(slam({"--force"}).exitCode, 0);
    const auto bare = readText(out_ / "trajectory_kitti.txt");
    run_ = std::make_unique<test::RunningTool>(
        "delio-slam", Words{"-i", rawlog_, "-o", out_, "--no-map", "--force", "--serve", "0"});
    findPort();
    std::set<std::size_t> points, poses;
    for (std::string answer; !(answer = httpGet(port_, "/live")).empty();) {
        const auto news = newsOf(answer);
        points.insert(news.count("all"));
        poses.insert(news.count("poses"));
    }
    const auto ended = run_->wait();
    ASSERT_EQ(ended.exitCode, 0) << ended.err;
    EXPECT_GT(points.size(), 3U) << "the map does not grow";
    EXPECT_GT(*poses.rbegin(), 15U);
    EXPECT_EQ(readText(out_ / "trajectory_kitti.txt"), bare);
}

TEST_F(Serve, NamesTheAxisThatATunnelHides) {
    ASSERT_EQ(
        test::runTool("synth2rawlog", {"-o", rawlog_, "--scene", "tunnel", "--sensor", "vlp16",
                                       "--scans", "25", "--seed", "3", "--start", "moving"})
            .exitCode,
        0);
    run_ = std::make_unique<test::RunningTool>(
        "delio-slam", Words{"-i", rawlog_, "-o", out_, "--no-map", "--serve", "0"});
    findPort();
    std::size_t one = 0;  // replies with the tunnel's axis alone
    for (std::string answer; !(answer = httpGet(port_, "/live")).empty();) {
        const auto news = newsOf(answer);
        const auto axes = news.head["weakAxes"].asSequence();
        EXPECT_LE(axes.size(), 3U);
        if (news.count("scans") < 2 || axes.size() != 1) continue;
        EXPECT_GT(std::abs(axes[0].asSequence()[0].as<double>()), 0.98);
        ++one;
    }
    run_->wait();  // with 1: such a drive is not to be relied on
    EXPECT_GT(one, 0U);
}

TEST_F(Serve, InABrowser) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    DELIO_NEED_PROGRAMS("chromium")
    start();
    drive();
    afterScans(8);
    const std::string picture = folder_ / "shot.png";
    const auto browse = [&] {
        return test::runTool(
            "timeout",
            {"60", "chromium", "--headless=new", "--no-sandbox", "--use-gl=angle",
             "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--window-size=1280,800",
             "--hide-scrollbars", "--user-data-dir=" + std::string(folder_ / "chromium"),
             "--enable-logging=stderr", "--virtual-time-budget=4000", "--dump-dom",
             "--screenshot=" + picture, "http://127.0.0.1:" + std::to_string(port_) + "/"});
    };
    constexpr int kTimeout = 124;
    auto shown = browse();
    if (shown.exitCode == kTimeout) shown = browse();  // Chromium itself hangs once in a while
    ASSERT_EQ(shown.exitCode, 0) << shown.err;
    EXPECT_EQ(shown.err.find("CONSOLE"), std::string::npos) << shown.err;
    std::smatch state;
    ASSERT_TRUE(std::regex_search(
        shown.out, state, std::regex("data-state=\"live ([0-9]+) points ([0-9]+) places\"")))
        << shown.out.substr(0, 2000);
    EXPECT_GT(std::stoi(state[1]), 300);
    EXPECT_GT(std::stoi(state[2]), 0);
    mrpt::img::CImage image;
    ASSERT_TRUE(image.loadFromFile(picture));
    if (const char* folder = std::getenv("DELIO_PICTURES"))
        image.saveToFile(std::string(folder) + "/serve.png");
    int coloured = 0;  // points, beside the panel
    for (unsigned y = 60; y < 770; ++y)
        for (unsigned x = 310; x < 1280; ++x) {
            const auto* pixel = image.ptr<std::uint8_t>(x, y);
            const auto [low, high] = std::minmax({pixel[0], pixel[1], pixel[2]});
            coloured += high > 100 && high - low > 60;
        }
    EXPECT_GT(coloured, 600);
    end();
}
}  // namespace
