"""What the robot senses: pictures, laser scans, and the truth behind them."""
