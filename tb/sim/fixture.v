// SPDX-License-Identifier: BSD-2-Clause
// A stand-in for the controller with the same pins, to test the simulator by itself. It answers so simply that every
// response can be worked out by hand:
//   firmware[0], [1]  on-time of the PWM of X (direction +) and Y (-), in clk cycles of 2500
//   boot[0]           low 32 bits: sent as four bytes, least significant first, after reset
//   serial            every byte received is sent back, plus one
//   report_tx         serial_rx, two clk late
//   sync_out          X's count (from its own two-flip-flop decoder) is above 100
//   encoder_out       A of X, two fast flip-flops late;  out0: in0, likewise
//   adc_mosi          button[2], one clk late;  adc_cs_n, adc_sck: low
//   flash             identification asked for again and again, a bit in two clk;  dir[3]: the last bit read, inverted
//   cpu_asleep        high except for one clk in sixteen, low with estop
//   dir[2]            toggles every 16 edges of cpu_clk
module abbe (
    input clk, rst, fast_clk, fast_rst, cpu_clk, cpu_rst,
    input [3:0] enc_a, enc_b, enc_z, limit_lower, limit_upper,
    input estop, in0, in1, serial_rx, joystick_button, adc_miso,
    input [3:0] button, dip, input [2:0] knob_a, knob_b,
    output reg [3:0] pwm, output reg [3:0] dir, output reg motor_enable,
    output out0, output sync_out, output encoder_out, output reg serial_tx, output report_tx, output cpu_asleep,
    output adc_cs_n, adc_sck, output reg adc_mosi, output flash_cs_n, flash_sck, flash_mosi, input flash_miso
);
    localparam PERIOD = 2500, DIVISOR = 434;

    reg [31:0] boot [0:3];
    reg [31:0] firmware [0:3];
    reg [8*1024-1:0] path;
    initial begin
        if ($value$plusargs("boot=%s", path)) $readmemh(path, boot);
        if ($value$plusargs("firmware=%s", path)) $readmemh(path, firmware);
    end

    reg [31:0] work;
    assign {adc_cs_n, adc_sck} = 0;

    // Flash: selected for 32 bits of 64, the first eight of them 0x9f.
    reg [6:0] flash_time;
    reg flash_bit;
    localparam [7:0] READ_ID = 8'h9f;
    assign flash_cs_n = flash_time[6] || rst;
    assign flash_sck = !flash_cs_n && flash_time[0];
    assign flash_mosi = flash_time[6:1] < 8 && READ_ID[3'd7 - flash_time[3:1]];
    always @(posedge clk) begin
        flash_time <= rst ? 0 : flash_time + 1;
        flash_bit <= flash_sck ? flash_miso : flash_bit;
    end
    always @(posedge clk) adc_mosi <= button[2];

    // Drive.
    reg [11:0] phase;
    always @(posedge clk)
        if (rst) begin
            phase <= 0; pwm <= 0; dir <= 0; motor_enable <= 0;
        end else begin
            phase <= phase == PERIOD - 1 ? 0 : phase + 1;
            pwm <= {2'b0, phase < firmware[1], phase < firmware[0]};
            dir <= {!flash_bit, work[4], 2'b01};
            motor_enable <= !estop;
        end

    // Encoder: counts edges of X.
    reg [1:0] a, b;
    reg i0, i1;
    reg signed [31:0] count;
    wire was_a = a[1], was_b = b[1], now_a = a[0], now_b = b[0];
    always @(posedge fast_clk) begin
        a <= {a[0], enc_a[0]}; b <= {b[0], enc_b[0]};
        i0 <= in0; i1 <= i0;
        if (fast_rst) count <= 0;
        else if (was_a != now_a || was_b != now_b)
            count <= now_a ^ was_b ? count + 1 : count - 1;
    end
    assign encoder_out = a[1];
    assign out0 = i1;
    reg above;
    always @(posedge fast_clk) above <= !fast_rst && count > 100;
    assign sync_out = above;

    // Serial: receive, add one, send.
    reg [1:0] rx;
    reg [9:0] rx_wait, tx_wait;
    reg [3:0] rx_bit, tx_bit;
    reg [7:0] rx_shift;
    reg [9:0] tx_shift;
    reg [7:0] queue [0:15];
    reg [3:0] head, tail;
    integer n;
    always @(posedge clk)
        if (rst) begin
            rx <= 2'b11; rx_wait <= 0; rx_bit <= 0; tx_wait <= 0; tx_bit <= 0; serial_tx <= 1;
            head <= 4; tail <= 0;
            for (n = 0; n < 4; n = n + 1) queue[n] <= boot[0][8*n +: 8];
        end else begin
            rx <= {rx[0], serial_rx};
            if (rx_bit == 0) begin
                if (!rx[1]) begin rx_bit <= 1; rx_wait <= DIVISOR + DIVISOR / 2 - 3; end
            end else if (rx_wait != 0) rx_wait <= rx_wait - 1;
            else begin
                rx_wait <= DIVISOR - 1;
                rx_bit <= rx_bit == 9 ? 0 : rx_bit + 1;
                if (rx_bit == 9) begin queue[head] <= rx_shift + 1; head <= head + 1; end
                else rx_shift <= {rx[1], rx_shift[7:1]};
            end
            if (tx_wait != 0) tx_wait <= tx_wait - 1;
            else if (tx_bit != 0) begin
                serial_tx <= tx_shift[0]; tx_shift <= tx_shift >> 1; tx_wait <= DIVISOR - 1; tx_bit <= tx_bit - 1;
            end else if (head != tail) begin
                tx_shift <= {1'b1, queue[tail], 1'b0}; tx_bit <= 10; tail <= tail + 1;
            end
        end

    assign report_tx = rx[1];

    // A CPU that works one clock in sixteen.
    reg [3:0] tick;
    always @(posedge clk) tick <= rst ? 0 : tick + 1;
    assign cpu_asleep = tick != 0 && !estop;
    always @(posedge cpu_clk) work <= cpu_rst ? 0 : work + 1;
endmodule
